/* Trail arithmetic (kernels/trail.clh) against recursion: for every number of children and size of
 * the short stack, the leaves of random trees are visited in the same order, under a limit that
 * shrinks on the way. Small enough for oclgrind. */
#include "framework/base/file.h"
#include "framework/base/random.h"
#include "kernels/bb_shared.h"
#include "tests/device_fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TREES = 64, NODES_MAX = 1500 };

static bb_source source = {.name = "trail_walk.cl"};

typedef struct walk_node {
    uint32_t first, count;
    float distance, hit;
} walk_node;

typedef struct forest {
    walk_node nodes[TREES * NODES_MAX];
    uint32_t begins[TREES];
    uint32_t visits[TREES][NODES_MAX]; /* ends with BB_NONE unless full */
    uint32_t visited[TREES];
} forest;

/* A random tree below nodes[n], of up to `children` per node and `levels` levels; on the way down
 * only one child in a while goes on, so that it gets deep. Distances are few, so that there are
 * ties. */
static void grow(walk_node *nodes, uint32_t *count, uint32_t n, uint32_t children, uint32_t levels,
                 bb_random *random)
{
    nodes[n].hit = nodes[n].distance + (float)bb_random_below(random, 6);
    uint32_t wanted = 1 + bb_random_below(random, children);
    if (levels == 0 || *count + wanted > NODES_MAX - 1)
        return;
    nodes[n].first = *count;
    nodes[n].count = wanted;
    *count += wanted;
    uint32_t deep = bb_random_below(random, wanted);
    for (uint32_t c = nodes[n].first; c < nodes[n].first + wanted; c++)
        nodes[c].distance =
            nodes[n].distance +
            (bb_random_below(random, 8) == 0 ? (float)bb_random_below(random, 3) : 0);
    for (uint32_t i = 0; i < wanted; i++)
        grow(nodes, count, nodes[n].first + i, children,
             i == deep ? levels - 1 : bb_random_below(random, levels < 4 ? levels : 4), random);
}

static void visit(forest *f, uint32_t tree, uint32_t n, float *limit)
{
    const walk_node *nodes = f->nodes + f->begins[tree], *node = &nodes[n];
    if (node->count == 0) {
        f->visits[tree][f->visited[tree]++] = n;
        *limit = fminf(*limit, node->hit);
        return;
    }
    bool done[8] = {false};
    for (;;) { /* the nearest that is left; of equals the lower */
        uint32_t best = BB_NONE;
        for (uint32_t i = 0; i < node->count; i++)
            if (!done[i] && (best == BB_NONE ||
                             nodes[node->first + i].distance < nodes[node->first + best].distance))
                best = i;
        if (best == BB_NONE || nodes[node->first + best].distance > *limit)
            return;
        done[best] = true;
        visit(f, tree, node->first + best, limit);
    }
}

static forest *make_forest(uint32_t children, uint32_t levels)
{
    forest *f = calloc(1, sizeof *f);
    uint32_t begin = 0;
    for (uint32_t t = 0; t < TREES; t++) {
        bb_random random = bb_random_make(seed, 1000 * children + t);
        uint32_t count = 1;
        f->begins[t] = begin;
        grow(f->nodes + begin, &count, 0, children, t % 4 == 0 || t > levels ? levels : t, &random);
        begin += count;
        float limit = INFINITY;
        visit(f, t, 0, &limit);
        if (f->visited[t] < NODES_MAX)
            f->visits[t][f->visited[t]] = BB_NONE;
    }
    return f;
}

static void compare(const forest *f, uint32_t children, uint32_t entries, uint32_t levels)
{
    char defines[96];
    snprintf(defines, sizeof defines, "-DBB_CHILDREN=%u -DBB_ENTRIES=%u -DBB_LEVELS=%u", children,
             entries, levels);
    cl_program program = NULL;
    cl_kernel kernel = NULL;
    bb_buffer nodes = {0}, begins = {0}, visits = {0};
    uint32_t capacity = NODES_MAX;
    uint32_t(*found)[NODES_MAX] = malloc(sizeof f->visits);
    check(bb_program_build(device, &source, defines, &program), "build");
    check(bb_kernel_get(program, "walk", &kernel), "walk");
    check(bb_buffer_reserve(device, NULL, sizeof f->nodes, "nodes", &nodes), "nodes");
    check(bb_buffer_reserve(device, NULL, sizeof f->begins, "begins", &begins), "begins");
    check(bb_buffer_reserve(device, NULL, sizeof f->visits, "visits", &visits), "visits");
    check(bb_buffer_write(&nodes, 0, sizeof f->nodes, f->nodes), "nodes");
    check(bb_buffer_write(&begins, 0, sizeof f->begins, f->begins), "begins");
    check(bb_launch(device, kernel, TREES, TREES, BB_MEM(nodes), BB_MEM(begins), BB_MEM(visits),
                    BB_VALUE(capacity)),
          "walk");
    check(bb_buffer_read(&visits, 0, sizeof f->visits, found), "visits");
    for (uint32_t t = 0; t < TREES; t++)
        for (uint32_t i = 0; i < NODES_MAX && i <= f->visited[t]; i++)
            if (found[t][i] != f->visits[t][i])
                fail_msg("%u children, %u entries, %u levels, tree %u: visit %u is node %u, not %u",
                         children, entries, levels, t, i, found[t][i], f->visits[t][i]);
    bb_buffer_release(&nodes);
    bb_buffer_release(&begins);
    bb_buffer_release(&visits);
    bb_kernel_release(kernel);
    bb_program_release(program);
    free(found);
}

static void the_trail_visits_what_recursion_does(void **state)
{
    (void)state;
    static const uint32_t entries[] = {0, 1, 2, 8};
    for (uint32_t children = 2; children <= 8; children *= 2)
        for (uint32_t levels = 64; levels <= 256; levels *= 4) { /* one word, and more */
            forest *f = make_forest(children, levels);
            for (size_t e = 0; e < sizeof entries / sizeof entries[0]; e++)
                compare(f, children, entries[e], levels);
            free(f);
        }
}

static int open_all(void **state)
{
    char *text = NULL;
    size_t size = 0;
    if (open_device(state) == 0 && bb_file_read(BB_TEST_SOURCE_DIR "/tests/trail_walk.cl", 1 << 20,
                                                "trail_walk.cl", &text, &size) == BB_OK) {
        source.text = text;
        return 0;
    }
    print_error("%s\n", bb_message());
    return -1;
}

static int close_all(void **state)
{
    close_device(state);
    free((void *)(uintptr_t)source.text);
    return 0;
}

int main(void)
{
    seed = 1969;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_trail_visits_what_recursion_does),
    };
    return cmocka_run_group_tests(tests, open_all, close_all);
}
