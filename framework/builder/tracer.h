/* The plug-in interface of tracers: who builds trees of its own and traces them by code of its own,
 * such as a library that users would take instead of a builder and a kernel.
 *
 * A tracer enters the same rounds on the same rays as builders do, and its answers are judged like
 * theirs. The harness has the clock and the threads: a tracer is called with a few rays at a time,
 * by as many threads as OpenCL uses.
 *
 * No function may change the rays, the scene, or what others share: how floats are computed, the
 * locale, signals, limits, processors, timers, the environment, the working folder, standard
 * streams. None leaves threads at work, or a process. Whoever does loses its row.
 *
 * A tracer is one constant struct, `const bb_tracer bb_tracer_NAME`, in tracers/NAME/NAME.c (or
 * .cpp, where it needs `extern "C"`); CMake finds the folder. Outside this tree,
 * `bvhbench_add_tracer(NAME)` makes a shared object of the same file, which exports `bb_plugin`:
 * see BB_TRACER_PLUGIN.
 */
#ifndef BB_TRACER_H
#define BB_TRACER_H

#include "framework/base/options.h"
#include "framework/base/variants.h"
#include "framework/builder/builder.h"
#include "framework/scene/scene.h"
#include "kernels/bb_shared.h"

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

/* Incremented whenever the layout or meaning of this header, or of a struct it uses, changes. */
enum { BB_TRACER_ABI_VERSION = 1 };

/* The harness passes this to create(); it outlives the object. */
typedef struct bb_tracer_context {
    /* What is to be traced, on the host, for as long as the object lives: kinds, counts, vertices,
     * data and boxes. Views and whatever else would tell of rays are zero. */
    const bb_scene *scene;
    const bb_spec *spec;      /* validated parameters */
    const bb_option *options; /* the tracer's own table, for bb_spec_u64() and the like */
    uint32_t threads;         /* to build with; trace() is called by as many */
} bb_tracer_context;

typedef struct bb_tracer bb_tracer;
struct bb_tracer {
    uint32_t abi_version; /* BB_TRACER_ABI_VERSION. Required. */
    const char *name;     /* lower case, digits, '-'; the folder's name. Required. */
    const char *summary;  /* one line for `list`. Required. */
    const char *paper;    /* authors, year ("none" for none). Required. */
    uint32_t kinds; /* primitive kinds it takes: BB_TRIANGLES | ..., or BB_ALL_KINDS. Required. */
    const bb_option *options; /* ends with name NULL. Optional. */
    /* The names, by commas, of those options that say how rays are passed, and do not change what
     * create() and build() make: rows that differ in nothing else share one object, whose pass() is
     * called before each. "" or NULL: none. */
    const char *passing;
    /* The name of the option on whose value answers depend, such as "mode": results show it in the
     * place of an intersector. Optional. */
    const char *exactness;
    const char *code; /* results show this in the place of a kernel. NULL: the name */
    /* Its variants that run where its parameters are not given (base/variants.h): the role
     * `compared`. NULL: the plain name. */
    const bb_variants *variants;

    /* Makes whatever comes before the first build of this scene; not part of a build's time, but
     * shown beside it (prepare_ms). If it fails after it
     * has set *self, only destroy() is called. BB_UNSUPPORTED: the library that was loaded lacks
     * what the parameters ask for. Required. */
    bb_status (*create)(const bb_tracer_context *context, void **self);

    /* Builds from the scene's arrays to what trace() needs, in bb_phase() spans. Called many times
     * on the same object, and each builds anew: what the arrays hold may have changed. Timed,
     * together with a few rays that trace() must answer right after it as it will later. Required.
     */
    bb_status (*build)(void *self, bb_phases *phases);

    /* Rays are passed as `spec` says from now on. Called before each trace, and timed with it.
     * BB_UNSUPPORTED as in create(). Optional. */
    bb_status (*pass)(void *self, const bb_spec *spec);

    /* Traces `count` rays and writes as many answers. With `any`, any hit in the ray's interval is
     * right, and need not be named: (0, BB_UNNAMED). Else the closest one, with its t and its
     * primitive in the scene's numbering. A miss is (INFINITY, BB_NONE). Called by several threads
     * at once, with rays that lie next to each other in the ray set. All answers are there when it
     * returns. Required. */
    bb_status (*trace)(void *self, const bb_ray *rays, uint32_t count, bool any, bb_hit *hits);

    /* Returns the bytes that it holds for this scene, beside the scene's own arrays. Without it, or
     * if that is clearly more, the harness takes what create() and build() add to the heap.
     * Optional. */
    uint64_t (*bytes)(void *self);

    /* Writes what was measured, such as "Embree 4.3.3", into one line. Not timed. Optional. */
    bb_status (*describe)(void *self, char *text, size_t capacity);

    /* Frees everything that create() has set. Not called if *self is NULL. Required. */
    void (*destroy)(void *self);
};

/* A tracer as shared objects export it to the registry. */
typedef struct bb_tracer_registration {
    char magic[8];        /* BB_TRACER_MAGIC without its final 0 */
    uint32_t abi_version; /* BB_TRACER_ABI_VERSION */
    uint32_t bytes;       /* size of this struct */
    const bb_tracer *tracer;
} bb_tracer_registration;

#define BB_TRACER_MAGIC "BVHBTRAC"

/* Exports a tracer from a shared object. bvhbench_add_tracer() generates this line. */
#define BB_TRACER_PLUGIN(tracer)                                                                   \
    extern const bb_tracer_registration bb_plugin;                                                 \
    __attribute__((visibility("default"))) const bb_tracer_registration bb_plugin = {              \
        BB_TRACER_MAGIC, BB_TRACER_ABI_VERSION, sizeof(bb_tracer_registration), &(tracer)}

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
