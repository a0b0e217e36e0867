/* For tests that make results row by row: empty ones, and read as from a file. */
#ifndef BB_TEST_DOCUMENT_FIXTURE_H
#define BB_TEST_DOCUMENT_FIXTURE_H

#include "framework/record/record_private.h"
#include "tests/document.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

static inline bb_results *empty_document(void)
{
    bb_results *results;
    ASSERT_OK(bb_results_make(&results));
    bb_put_number(bb_results_entry(results, (bb_cell){{NULL}}), BB_F_CONTEXT_THREADS, 4);
    return results;
}

static inline void add_scene(bb_results *results, const char *name, double prims)
{
    bb_put_number(bb_results_entry(results, (bb_cell){{[BB_SCENE] = name}}), BB_F_SCENE_PRIMS,
                  prims);
}

static inline bb_entry *new_build(bb_results *results, const char *scene, const char *builder)
{
    const bb_cell cell = {{[BB_SCENE] = scene, [BB_BUILDER] = builder}};
    assert_null(bb_results_find(results, cell));
    bb_entry *build = bb_results_entry(results, cell);
    assert_non_null(build);
    bb_put_text(build, BB_F_BUILD_STATUS, "ok");
    return build;
}

/* A trace of a million rays. */
static inline bb_entry *new_trace(bb_results *results, const char *scene, const char *builder,
                                  const char *rays, const char *kernel, const char *intersector)
{
    const bb_cell cell = {{[BB_SCENE] = scene,
                           [BB_QUESTION] = rays,
                           [BB_BUILDER] = builder,
                           [BB_KERNEL] = kernel,
                           [BB_INTERSECTOR] = intersector}};
    assert_null(bb_results_find(results, cell));
    bb_entry *trace = bb_results_entry(results, cell);
    assert_non_null(trace);
    bb_put_text(trace, BB_F_TRACE_STATUS, "ok");
    bb_put_text(trace, BB_F_TRACE_RAYS_HASH, rays);
    bb_put_number(trace, BB_F_TRACE_COUNT, 1e6);
    return trace;
}

/* Traces get keys. The results are freed. */
static inline bb_results *read_back(bb_results *results)
{
    for (bb_entry *trace = results->sections[BB_TRACES].first; trace != NULL; trace = trace->next)
        bb_put_missing_key(trace);
    const char *folder = getenv("BVHBENCH_TEST_DIR");
    char path[600];
    bb_results *again = NULL;
    folder = folder != NULL ? folder : "/tmp";
    mkdir(folder, 0777);
    snprintf(path, sizeof path, "%s/document-%ld.json", folder, (long)getpid());
    ASSERT_OK(bb_results_write(results, path));
    bb_results_destroy(results);
    ASSERT_OK(bb_results_read(path, &again));
    remove(path);
    return again;
}

#endif
