#include "framework/cli/out_option.h"

#include "framework/base/file.h"

#include <errno.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The output folder, if it was made. It and its parents whose paths are longer than `there` are
 * new. A command has one output folder. */
static char made[PATH_MAX];
static size_t there;

/* Makes the folder of the first `length` characters, unless it exists. */
static bb_status make_first(const char *path, size_t length)
{
    char part[PATH_MAX];
    snprintf(part, sizeof part, "%.*s", (int)length, path);
    if (mkdir(part, 0777) == 0) {
        if (made[0] == '\0') {
            there = length - 1;
            snprintf(made, sizeof made, "%s", path);
        }
        return BB_OK;
    }
    const int error = errno;
    struct stat info;
    if (stat(part, &info) != 0)
        return bb_fail(BB_INVALID, "cannot make the output folder %s: %s", part, strerror(error));
    if (!S_ISDIR(info.st_mode))
        return bb_fail(BB_INVALID, "cannot make the output folder %s: %s is a file: name another",
                       path, part);
    return BB_OK;
}

static bb_status try_to_write(const char *folder)
{
    char probe[PATH_MAX + 32];
    snprintf(probe, sizeof probe, "%s/.bvhbench-XXXXXX", folder);
    int file = mkstemp(probe);
    if (file < 0)
        return bb_fail(BB_INVALID, "cannot write into the output folder %s: %s", folder,
                       strerror(errno));
    close(file);
    unlink(probe);
    return BB_OK;
}

bb_status bb_out_folder(const char *path)
{
    const size_t length = strlen(path);
    if (length >= PATH_MAX)
        return bb_fail(BB_INVALID, "%.60s...: the path of the output folder is too long", path);
    for (size_t i = 1; i <= length; i++)
        if (path[i - 1] != '/' && (path[i] == '/' || path[i] == '\0'))
            BB_TRY(make_first(path, i));
    return try_to_write(path);
}

bb_status bb_out_file(const char *path, const char *what)
{
    struct stat info;
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode))
        return bb_fail(BB_INVALID, "%s %s is not a regular file: name another", what, path);
    char *folder = bb_file_folder(path);
    if (folder == NULL)
        return bb_fail(BB_FAILED, "%s %s: no memory", what, path);
    bb_status status = bb_out_folder(folder);
    free(folder);
    return status == BB_OK ? BB_OK : bb_fail(status, "%s %s: %s", what, path, bb_message());
}

void bb_out_tidy(void)
{
    for (size_t length = strlen(made); length > there; length--) {
        const bool ends = made[length - 1] != '/' && (made[length] == '/' || made[length] == '\0');
        made[length] = '\0';
        if (ends && rmdir(made) != 0)
            break;
    }
    made[0] = '\0';
}
