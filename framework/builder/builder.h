/* The plug-in interface: a BVH builder, or a stage before or after one.
 *
 * A builder makes a tree from the scene. A specification may put a splitter before it, which turns
 * primitives into references to build over, and optimisers after it, which turn its tree into
 * another: `presplit+sah+rotate`. All three are declared by the same struct: a splitter has split()
 * instead of build(), an optimiser declares BB_INPUT_TREE.
 *
 * A builder is one constant struct, `const bb_builder bb_builder_NAME`, in builders/NAME/NAME.c.
 * Its device code is in the same folder: .cl files, the .clh files they include, and the _shared.h
 * files that both sides include. CMake finds the folder; nothing else has to be touched. Outside
 * this tree, `bvhbench_add_builder(NAME)` makes a shared object of the same files, which exports
 * `bb_plugin`: see BB_PLUGIN.
 */
#ifndef BB_BUILDER_H
#define BB_BUILDER_H

#include "framework/base/decision.h"
#include "framework/base/options.h"
#include "framework/base/variants.h"
#include "framework/builder/references.h"
#include "framework/builder/tree.h"
#include "framework/device/device.h"
#include "framework/device/primitives.h"
#include "framework/scene/scene.h"

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

/* Incremented whenever the layout or meaning of this header, or of a struct it uses, changes. */
enum { BB_ABI_VERSION = 17 };

/* The inputs that a builder may declare. They are in place when the clock starts. Everything else
 * in the scene that the hooks get is zero, except kinds, counts and names. Views are withheld too,
 * since rays follow from them, unless the builder has an option `view` and it was given. A builder
 * that declares a volume gets its geometry and transfer function, but not the list of visible
 * bricks, which the harness computes for itself.
 *
 * After a splitter, boxes and prim_count describe its references, and the tree's refs are indices
 * of references, which the harness then replaces by primitives. Profile and counts per kind remain
 * those of the scene. References have none of BB_INPUTS_OF_PRIMITIVES: a builder that declares one
 * of them is refused after a splitter. */
enum {
    BB_INPUT_BOXES = 1u << 0,    /* on_device.boxes; builders on the host also get boxes */
    BB_INPUT_GEOMETRY = 1u << 1, /* vertices and data of prims, in the same places */
    BB_INPUT_TREE = 1u << 2,     /* for optimisers: the tree of the stage before */
    BB_INPUT_PROFILE = 1u << 3,  /* bounds and profile: measured by the harness, not timed */
    BB_INPUT_VOLUME = 1u << 4,   /* volume, and on_device.bricks, ranges and seen */
    BB_INPUT_TETS = 1u << 5,     /* tets and on_device.tet_flags, if the scene has tetrahedra */
    BB_INPUT_OBJECTS = 1u << 6, /* object_starts and movers, if the scene says; not of references */
    BB_INPUTS_OF_PRIMITIVES = BB_INPUT_GEOMETRY | BB_INPUT_VOLUME | BB_INPUT_TETS,
};

enum { BB_STAGES_MAX = 4 }; /* in a pipeline */

enum { BB_PHASES_MAX = 16, BB_EVENTS_MAX = 8 };

/* Named spans inside a build. Their boundaries are exact for work on the host. For work on the
 * device they are exact only in builds that the harness makes for this purpose, since each boundary
 * then waits for the queue. The clock itself is the harness's; in builds that a builder makes for
 * itself it is NULL, which all of the following take. */
typedef struct bb_phases bb_phases;

/* Ends the current phase and begins `name` (a string constant); NULL only ends it. If a name is
 * used again, its times add up. */
bb_status bb_phase(bb_phases *phases, const char *name);

/* Like bb_phase(), for a phase that is not part of the method, such as converting a library's own
 * tree: it is recorded, and subtracted from the build's time. BB_FAILED for builders on the device,
 * whose phases have no clock of their own. */
bb_status bb_phase_outside(bb_phases *phases, const char *name);

/* Marks a build as made on the host, whatever the builder's place is. To be called before its first
 * phase. Boundaries are then exact, and the device's clock need not have seen any work. */
void bb_phases_on_host(bb_phases *phases);

/* Counts something that a build or an update did ("moved", "reinserted", "thinned"), for the
 * record. `name` is a string constant; if it is used again, its numbers add up. BB_FAILED for more
 * than BB_EVENTS_MAX names. */
bb_status bb_event(bb_phases *phases, const char *name, uint64_t number);

/* The harness passes this to create(); it outlives the object. */
typedef struct bb_builder_context {
    bb_device *device;
    bb_account *account;      /* book all memory here */
    const bb_spec *spec;      /* validated parameters */
    const bb_option *options; /* the builder's own table, for bb_spec_u64() and the like */
    uint64_t seed;            /* random seed: the same seed gives the same tree */
    uint32_t threads;         /* host threads to use */
} bb_builder_context;

typedef struct bb_builder bb_builder;
struct bb_builder {
    uint32_t abi_version; /* BB_ABI_VERSION. Required. */
    const char *name;     /* lower case, digits, '-'; the folder's name. Required. */
    const char *summary;  /* one line for `list`. Required. */
    const char *paper;    /* the implemented paper: authors, year; its BibTeX is in NAME.bib, beside
                           * NAME.c. Required ("none" for none). */
    uint32_t kinds;  /* primitive kinds it takes: BB_TRIANGLES | ..., or BB_ALL_KINDS. Required. */
    uint32_t inputs; /* BB_INPUT_... Required. */
    bb_place place;  /* where it makes its tree. Required. */
    /* The same input gives the same tree, bit for bit. Must be true; false is an exception that the
     * summary explains and `check` reports. */
    bool deterministic;
    const bb_option *options; /* ends with name NULL. Optional. */
    /* Its variants that run where no builder is named (base/variants.h), on all devices. Optional.
     * NULL: the plain name is compared, unless it is only a stage (pipeline.h). */
    const bb_variants *variants;

    /* Compiles and allocates everything that does not depend on the scene; not timed. Called once
     * per object. *self is NULL before the call, and is passed to all other hooks. If create()
     * fails after it has set *self, only destroy() is called: set *self as soon as there is
     * something to free. Required. */
    bb_status (*create)(const bb_builder_context *context, void **self);

    /* Allocates the memory that build() needs for this scene, so that build() need not. Called
     * before the first build of a scene, and again if the number of references changes; not part of
     * the build's time, but recorded. `tree` is NULL for a splitter. Optional. */
    bb_status (*prepare)(void *self, const bb_scene *scene, bb_tree *tree);

    /* Fills `tree` from the declared input, in bb_phase() spans. It is timed from a finished queue
     * to a finished queue, and need not wait itself. `input` is NULL unless BB_INPUT_TREE is
     * declared: then it is the tree of the previous stage at this builder's `place` (a copy, if it
     * was made on the other side), and must not be changed. Called many times on the same object.
     * Required, except for a splitter. */
    bb_status (*build)(void *self, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases);

    /* Makes this a splitter: fills `references`; called instead of build() and timed like it. Each
     * primitive gets one or more references, whose boxes together contain it. Optional. */
    bb_status (*split)(void *self, const bb_scene *scene, bb_references *references,
                       bb_phases *phases);

    /* Brings `tree`, built by this object, up to date after `changed` (BB_CHANGED_...) happened to
     * the same primitives. It is timed like build(), and restore() precedes it too. The result must
     * be a valid tree for the current state, but need not be the one that build() would make. If
     * only boxes of nodes changed, a call of bb_tree_boxes_changed() saves the layouts work.
     * BB_UNSUPPORTED if it cannot or should not follow the change: the harness then builds again,
     * as it does without this hook, and adds the time spent so far if a phase had begun. In a
     * pipeline the hook of the last stage is called, unless there is a splitter. Optional. */
    bb_status (*update)(void *self, const bb_scene *scene, uint32_t changed, bb_tree *tree,
                        bb_phases *phases);

    /* Restores the input that build() destroys, before each build or update; not part of the
     * build's time, but recorded. A builder that takes more than a tenth of its build for this and
     * for phases outside is not ranked by its builds. Optional. */
    bb_status (*restore)(void *self, const bb_scene *scene);

    /* Describes the last build for the record, in one line without a newline. It adds to the
     * figures, such as the bit layout of a code or the chosen level. Not timed. Optional. */
    bb_status (*describe)(void *self, const bb_scene *scene, char *text, size_t capacity);

    /* Appends the decisions made for the last build, with their figures, such as the length of a
     * code or the number of levels. Not timed. Optional. */
    void (*decide)(void *self, const bb_scene *scene, bb_decisions *decisions);

    /* Frees everything that create() has set. Called once, also after a build that failed and after
     * a create() that failed half-way: members that it did not reach are as it left them. Not
     * called if *self is NULL. Required. */
    void (*destroy)(void *self);
};

/* A builder and its device files, as a shared object exports them to the registry. */
typedef struct bb_registration {
    char magic[8];        /* BB_PLUGIN_MAGIC without its final 0 */
    uint32_t abi_version; /* BB_ABI_VERSION */
    uint32_t bytes;       /* size of this struct */
    const bb_builder *builder;
    const bb_source *files; /* device files of its folder; ends with name NULL. NULL: none */
} bb_registration;

#define BB_PLUGIN_MAGIC "BVHBPLUG"

/* Exports a builder from a shared object. bvhbench_add_builder() generates this line; a plug-in
 * built by other means needs it at the end of its NAME.c. */
#define BB_PLUGIN(builder, files)                                                                  \
    extern const bb_registration bb_plugin;                                                        \
    __attribute__((visibility("default"))) const bb_registration bb_plugin = {                     \
        BB_PLUGIN_MAGIC, BB_ABI_VERSION, sizeof(bb_registration), &(builder), (files)}

/* A builder's role in a pipeline: a splitter, an optimiser, or neither. */
static inline bool bb_is_splitter(const bb_builder *builder)
{
    return builder->split != NULL;
}

static inline bool bb_is_optimiser(const bb_builder *builder)
{
    return (builder->inputs & BB_INPUT_TREE) != 0;
}

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
