/* Bugs planted in the device code, one at a time (`--kernels-from`): what makes `exact` exact is
 * exercised end to end, so `run` must say that answers are wrong, or unlike those of another
 * kernel. Without a bug it must not. */
#include "tests/fixture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>

static const char *folder; /* has the device code in place of the program's */

typedef struct plant {
    const char *what;
    const char *file, *find, *replace; /* `find` stands there once */
    const char *scene, *kernels;
} plant;

static const char blocks[] = "blocks:side=6,mixed=yes";
static const char boards[] = "boards:length=1e5", ground[] = "ground", ladder[] = "ladder";

static const plant plants[] = {
    {"distances of planes are not padded", "padding.clh", "BB_PAD_DISTANCE 0x1.8p-19f",
     "BB_PAD_DISTANCE 0.0f", ground, "stack"},
    {"boxes are not padded", "padding.clh", "BB_PAD_BOX 0x1.4p-20f", "BB_PAD_BOX 0.0f", boards,
     "stack"},
    {"edges belong to no triangle", "triangle_watertight.clh", "| (det == 0.0f);",
     "| (det == 0.0f) | (u == 0.0f) | (v == 0.0f) | (w == 0.0f);", ground, "stack"},
    {"differences of products are rounded twice", "triangle_watertight.clh",
     "return fma(a, b, -cd) + error;", "return a * b - cd;", boards, "stack"},
    {"differences of products miss their error", "triangle_watertight.clh",
     "return fma(a, b, -cd) + error;", "return fma(a, b, -cd);", boards, "stack"},
    {"a stack has one entry too few", "stack.cl", "if (top == BB_STACK_SIZE)",
     "if (top + 1u == BB_STACK_SIZE) { link = entry.y < entry.x ? links.y : links.x; continue; }\n"
     "if (top == BB_STACK_SIZE)",
     ladder, "stack"},
    {"quantised boxes start inside", "layout_wide.cl", "step_below(node, axis, los[c]);",
     "min(255u, step_below(node, axis, los[c]) + 1u);", boards, "stack8q"},
    {"quantised boxes end inside", "layout_wide.cl", "step_above(node, axis, his[c]);",
     "max(1u, step_above(node, axis, his[c])) - 1u;", boards, "stack8q"},
    {"a trail is one level off", "trail.clh", "return 64u * w + bit;",
     "return 64u * w + bit + (bit > 2u ? 1u : 0u);", boards, "trail"},
    {"boxes are left, not entered", "prim_aabb.clh", "entry > tmin ? entry : exit", "exit", blocks,
     "stack8"},
    {"boxes have no inside", "prim_aabb.clh", "return entry <= exit ?",
     "return (entry <= exit) & (entry > tmin) ?", blocks, "stack"},
    {"a kind's data lie elsewhere", "prims.clh", "(ends->end[BB_##NAME] - first);",
     "ends->end[BB_##NAME];", blocks, "stack8"},
};
enum { PLANTS = sizeof plants / sizeof plants[0] };

static const char rays[] = "--rays edges:jitter=64 --rays edges:jitter=64,from=around --rays "
                           "primary --rays random --size 64x64";

static void read_file(const char *path, char *text, size_t capacity)
{
    FILE *file = fopen(path, "rb");
    if (file == NULL)
        fail_msg("%s: cannot be read", path);
    size_t length = fread(text, 1, capacity, file);
    fclose(file);
    assert_true(length < capacity);
    text[length] = '\0';
}

/* The file of kernels/ with the bug, or as it is. */
static void write_planted(const plant *p, int planted)
{
    static char text[65536];
    char path[512];
    snprintf(path, sizeof path, BB_TEST_SOURCE_DIR "/kernels/%s", p->file);
    read_file(path, text, sizeof text);
    char *at = strstr(text, p->find);
    if (at == NULL || strstr(at + 1, p->find) != NULL)
        fail_msg("%s: '%s' must stand there once: mend the plant", path, p->find);
    snprintf(path, sizeof path, "%s/%s", folder, p->file);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fwrite(text, 1, (size_t)(at - text), file);
    fputs(planted ? p->replace : p->find, file);
    fputs(at + strlen(p->find), file);
    assert_int_equal(fclose(file), 0);
}

/* Exit status of `run`, and what it printed. */
static int run(const plant *p, char *out, size_t capacity)
{
    char command[2048], path[512];
    snprintf(path, sizeof path, "%s.txt", folder);
    snprintf(command, sizeof command,
             BB_TEST_PROGRAM " run --scene %s --builder lbvh --kernel %s %s --max-rays 65536 "
                             "--repeats 1 --no-pictures --charts no --kernels-from %s --out %s.out "
                             ">%s 2>&1 </dev/null",
             p->scene, p->kernels, rays, folder, folder, path);
    int status = system(command);
    read_file(path, out, capacity);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void each_bug_is_found(void **state)
{
    (void)state;
    static char out[65536];
    int count =
        getenv("BVHBENCH_TEST_SMALL") != NULL ? 1 : PLANTS; /* the host's code is the same */
    for (int planted = 1; planted >= 0; planted--)
        for (int i = 0; i < count; i++) {
            const plant *p = &plants[i];
            char path[512];
            int seen = 0; /* without a bug one run of a scene and a kernel tells for all */
            for (int k = 0; k < i && !planted; k++)
                seen = seen ||
                       (plants[k].scene == p->scene && strcmp(plants[k].kernels, p->kernels) == 0);
            if (seen)
                continue;
            write_planted(p, planted);
            int status = run(p, out, sizeof out);
            int said = strstr(out, "cells or builds are wrong") != NULL;
            print_message("%-45s %-8s exit %d\n", p->what, planted ? "planted" : "mended", status);
            if (status != planted || said != planted)
                print_error("%s", out);
            assert_int_equal(status, planted);
            assert_int_equal(said, planted);
            snprintf(path, sizeof path, "%s/%s", folder, p->file);
            assert_int_equal(remove(path), 0);
        }
}

static int make_folder(void **state)
{
    (void)state;
    static char path[512];
    const char *parent = getenv("BVHBENCH_TEST_DIR");
    snprintf(path, sizeof path, "%s", parent != NULL ? parent : "/tmp");
    mkdir(path, 0777);
    strcat(path, "/plants");
    mkdir(path, 0777);
    folder = path;
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(each_bug_is_found)};
    return cmocka_run_group_tests(tests, make_folder, NULL);
}
