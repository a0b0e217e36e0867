/* What the tests of the scene loaders share: a folder for small files, and loads that must succeed
 * or fail with given words. */
#ifndef BB_SCENE_FILES_H
#define BB_SCENE_FILES_H

#include "framework/scene/scene.h"
#include "tests/fixture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* The path of a file in this test's folder, which is made. Valid until the eighth call after. */
static inline const char *test_path(const char *test, const char *name)
{
    static char paths[8][1024];
    static int next;
    char *path = paths[next++ % 8];
    const char *base = getenv("BVHBENCH_TEST_DIR");
    base = base != NULL ? base : "/tmp/bvhbench-tests";
    mkdir(base, 0777);
    snprintf(path, sizeof paths[0], "%s/%s", base, test);
    mkdir(path, 0777);
    snprintf(path, sizeof paths[0], "%s/%s/%s", base, test, name);
    return path;
}

static inline void write_bytes(const char *path, const void *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static inline void write_text(const char *path, const char *text)
{
    write_bytes(path, text, strlen(text));
}

static inline bb_scene *load_scene(const char *text)
{
    bb_scene *scene = NULL;
    if (bb_scene_load(text, &scene) != BB_OK)
        fail_msg("%s: %s", text, bb_message());
    return scene;
}

/* The load must fail with this status, and one line that holds `words`. */
static inline void expect_failure(const char *text, bb_status status, const char *words)
{
    bb_scene *scene = NULL;
    bb_status got = bb_scene_load(text, &scene);
    if (got != status || scene != NULL)
        fail_msg("%s: status %d instead of %d", text, (int)got, (int)status);
    if (strstr(bb_message(), words) == NULL || strchr(bb_message(), '\n') != NULL)
        fail_msg("%s: the message lacks '%s': %s", text, words, bb_message());
}

#endif
