/* What the targets share. A target is LLVMFuzzerTestOneInput(): it takes any bytes, asserts more
 * than that nothing crashes, and leaves nothing behind. libFuzzer calls it (scripts/fuzz), or
 * replay.c, which is the test. */
#ifndef BB_FUZZ_H
#define BB_FUZZ_H

#include "framework/base/status.h"

#include <fcntl.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A property that does not hold ends the process as a crash does, so that the input is kept. */
#define FUZZ_CHECK(condition)                                                                      \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            fprintf(stderr, "%s:%d: does not hold: %s (last message: %s)\n", __FILE__, __LINE__,   \
                    #condition, bb_message());                                                     \
            abort();                                                                               \
        }                                                                                          \
    } while (0)

/* A refusal says something, in one line, and is no success. */
static inline void fuzz_refused(bb_status status)
{
    FUZZ_CHECK(status != BB_OK);
    FUZZ_CHECK(bb_message()[0] != '\0');
    FUZZ_CHECK(strpbrk(bb_message(), "\n\r") == NULL);
}

/* The input as a text, from malloc, exactly as long as it is: reading on is seen. */
static inline char *fuzz_text(const uint8_t *data, size_t size)
{
    char *text = malloc(size + 1);
    FUZZ_CHECK(text != NULL);
    if (size > 0)
        memcpy(text, data, size);
    text[size] = '\0';
    return text;
}

/* ---- files ---- */

static char fuzz_folder[64];

static inline void fuzz_remove_folder(void)
{
    char command[128];
    snprintf(command, sizeof command, "rm -rf %s", fuzz_folder);
    if (fuzz_folder[0] != '\0')
        (void)!system(command);
}

/* The path of a file in this process' own folder, in memory where there is such a place. Valid
 * until the fourth call after. */
static inline const char *fuzz_path(const char *name)
{
    static char paths[4][128];
    static unsigned next;
    char *path = paths[next++ % 4];
    if (fuzz_folder[0] == '\0') {
        snprintf(fuzz_folder, sizeof fuzz_folder, "%s/bvhbench-fuzz-XXXXXX",
                 access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp");
        FUZZ_CHECK(mkdtemp(fuzz_folder) != NULL);
        atexit(fuzz_remove_folder);
    }
    snprintf(path, sizeof paths[0], "%s/%s", fuzz_folder, name);
    return path;
}

static inline const char *fuzz_file(const char *name, const void *data, size_t size)
{
    const char *path = fuzz_path(name);
    int file = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    FUZZ_CHECK(file >= 0);
    FUZZ_CHECK(write(file, data, size) == (ssize_t)size);
    close(file);
    return path;
}

#endif
