#include "framework/base/beside.h"

#include "framework/base/file.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define INSTALLED (BB_LIBDIR[0] == '/' ? BB_LIBDIR : BB_INSTALL_PREFIX "/" BB_LIBDIR)

static bool has(const char *folder, const char *name, char *path, size_t capacity)
{
    int length = snprintf(path, capacity, "%s/%s", folder, name);
    return length > 0 && (size_t)length < capacity && access(path, R_OK) == 0;
}

bool bb_find_beside(const char *name, char *path, size_t capacity)
{
    Dl_info info;
    bool (*self)(const char *, char *, size_t) = bb_find_beside;
    void *address;
    memcpy(&address, &self, sizeof address);
    if (dladdr(address, &info) != 0 && info.dli_fname != NULL) {
        char *folder = bb_file_folder(info.dli_fname);
        bool found = folder != NULL && has(folder, name, path, capacity);
        free(folder);
        if (found)
            return true;
    }
    return has(INSTALLED, name, path, capacity);
}
