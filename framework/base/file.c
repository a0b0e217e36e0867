/* Whole files. A file is written under a temporary name and moved by rename(2), which replaces the
 * old file in one step. */
#include "framework/base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

bb_status bb_input_open(const char *path, const char *what, bb_input *input)
{
    *input = (bb_input){.path = path, .what = what};
    /* O_NONBLOCK: a pipe without a writer must not hang us. */
    int handle = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (handle < 0)
        return bb_fail(BB_INVALID, "%s %s: %s", what, path, strerror(errno));
    struct stat info;
    if (fstat(handle, &info) != 0 || !S_ISREG(info.st_mode)) {
        close(handle);
        return bb_fail(BB_INVALID, "%s %s is not a regular file", what, path);
    }
    input->handle = handle;
    input->size = (uint64_t)info.st_size;
    return BB_OK;
}

/* The size was taken when the file was opened: fewer bytes mean that it shrank since, or that the
 * caller asks for more than it holds. */
bb_status bb_input_read(bb_input *input, void *data, size_t size)
{
    size_t done = 0;
    while (done < size) {
        ssize_t got = read(input->handle, (char *)data + done, size - done);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return bb_fail(BB_INVALID, "%s %s: %s", input->what, input->path, strerror(errno));
        if (got == 0)
            return bb_fail(BB_INVALID, "%s %s became shorter while it was read", input->what,
                           input->path);
        done += (size_t)got;
    }
    return BB_OK;
}

void bb_input_close(bb_input *input)
{
    close(input->handle);
}

bb_status bb_file_read(const char *path, size_t limit, const char *what, char **data, size_t *size)
{
    *data = NULL;
    *size = 0;
    bb_input input;
    BB_TRY(bb_input_open(path, what, &input));
    bb_status status = BB_OK;
    char *text = NULL;
    if (input.size > limit) {
        status = bb_fail(BB_INVALID, "%s %s has %llu bytes, more than the %zu that are read", what,
                         path, (unsigned long long)input.size, limit);
        goto out;
    }
    text = malloc((size_t)input.size + 1);
    if (text == NULL) {
        status = bb_fail(BB_FAILED, "%s %s: no memory for %llu bytes", what, path,
                         (unsigned long long)input.size);
        goto out;
    }
    status = bb_input_read(&input, text, (size_t)input.size);
    if (status != BB_OK)
        goto out;
    text[input.size] = '\0';
    *data = text;
    *size = (size_t)input.size;
    text = NULL;
out:
    free(text);
    bb_input_close(&input);
    return status;
}

/* Returns 0 or errno. */
static int write_all(int file, const char *data, size_t size)
{
    size_t done = 0;
    while (done < size) {
        ssize_t put = write(file, data + done, size - done);
        if (put < 0 && errno == EINTR)
            continue;
        if (put < 0)
            return errno;
        done += (size_t)put;
    }
    return 0;
}

bb_status bb_file_write(const char *path, const void *data, size_t size, const char *what)
{
    return bb_file_write_parts(path, &(bb_file_part){data, size}, 1, what);
}

bb_status bb_file_write_parts(const char *path, const bb_file_part *parts, size_t count,
                              const char *what)
{
    /* Renaming onto a device or a pipe would replace it. */
    struct stat info;
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode))
        return bb_fail(BB_INVALID, "%s: %s is not a regular file: name another one", what, path);

    static unsigned counter;
    size_t length = strlen(path) + 48;
    char *temporary = malloc(length);
    if (temporary == NULL)
        return bb_fail(BB_FAILED, "%s %s: no memory", what, path);
    snprintf(temporary, length, "%s.%ld-%u.tmp", path, (long)getpid(),
             __atomic_fetch_add(&counter, 1u, __ATOMIC_RELAXED));

    bb_status status = BB_OK;
    int file = open(temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file < 0) {
        status = bb_fail(BB_INVALID,
                         "%s: cannot write %s: %s: name a folder that exists and can be written",
                         what, path, strerror(errno));
        goto out;
    }
    int error = 0;
    for (size_t i = 0; i < count && error == 0; i++)
        error = write_all(file, parts[i].data, parts[i].size);
    if (error == 0 && fsync(file) != 0)
        error = errno;
    if (close(file) != 0 && error == 0)
        error = errno;
    if (error == 0 && rename(temporary, path) != 0)
        error = errno;
    if (error != 0) {
        unlink(temporary);
        status = bb_fail(error == ENOSPC ? BB_FAILED : BB_INVALID, "%s: cannot write %s: %s", what,
                         path, strerror(error));
    }
out:
    free(temporary);
    return status;
}

bb_status bb_temporary_folder(char path[PATH_MAX])
{
    const char *base = getenv("TMPDIR");
    const int length = snprintf(path, PATH_MAX, "%s/bvhbench-XXXXXX",
                                base != NULL && base[0] != '\0' ? base : "/tmp");
    if (length < PATH_MAX && mkdtemp(path) != NULL)
        return BB_OK;
    const int error = length < PATH_MAX ? errno : ENAMETOOLONG;
    const bb_status status =
        bb_fail(BB_INVALID, "cannot make the folder %s: %s: set TMPDIR to one that can be written",
                path, strerror(error));
    path[0] = '\0';
    return status;
}

static int remove_entry(const char *path, const struct stat *info, int kind, struct FTW *place)
{
    (void)info;
    (void)kind;
    (void)place;
    return remove(path);
}

void bb_remove_folder(const char *path)
{
    if (path[0] != '\0')
        (void)nftw(path, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
}

char *bb_file_folder(const char *path)
{
    const char *slash = strrchr(path, '/');
    if (slash == NULL)
        return strdup(".");
    return slash == path ? strdup("/") : strndup(path, (size_t)(slash - path));
}
