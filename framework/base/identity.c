#include "framework/base/identity.h"

#include <dirent.h>
#include <stdio.h>
#include <string.h>
#include <xxhash.h>

bb_identity *bb_identity_begin(void)
{
    bb_identity *identity = XXH3_createState();
    if (identity != NULL)
        XXH3_64bits_reset(identity);
    return identity;
}

void bb_identity_add(bb_identity *identity, const void *bytes, size_t size)
{
    if (identity != NULL)
        XXH3_64bits_update(identity, bytes, size);
}

void bb_identity_add_text(bb_identity *identity, const char *text)
{
    text = text != NULL ? text : "";
    bb_identity_add(identity, text, strlen(text) + 1);
}

void bb_identity_add_file(bb_identity *identity, const char *path)
{
    char buffer[1 << 14];
    size_t size;
    FILE *file = fopen(path, "rb");
    while (file != NULL && (size = fread(buffer, 1, sizeof buffer, file)) > 0)
        bb_identity_add(identity, buffer, size);
    if (file != NULL)
        fclose(file);
}

void bb_identity_add_folder(bb_identity *identity, const char *path)
{
    DIR *folder = opendir(path);
    uint64_t sum = 0, hash = 0;
    for (const struct dirent *e; folder != NULL && (e = readdir(folder)) != NULL;) {
        char file[4352];
        bb_identity *one = bb_identity_begin();
        snprintf(file, sizeof file, "%s/%s", path, e->d_name);
        bb_identity_add_text(one, e->d_name);
        bb_identity_add_file(one, file);
        if (bb_identity_end(one, path, &hash) == BB_OK)
            sum += hash;
    }
    if (folder != NULL)
        closedir(folder);
    bb_identity_add(identity, &sum, sizeof sum);
}

bb_status bb_identity_end(bb_identity *identity, const char *what, uint64_t *hash)
{
    if (identity == NULL)
        return bb_fail(BB_FAILED, "%s: no memory", what);
    *hash = XXH3_64bits_digest(identity);
    XXH3_freeState(identity);
    return BB_OK;
}
