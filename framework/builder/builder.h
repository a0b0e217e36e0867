/* The plug-in interface: what a builder of BVHs is, or a stage before or after one.
 *
 * A builder makes a tree of the scene. A specification may put a splitter before it, which makes
 * references of the primitives for it to build over, and optimisers after it, which make a tree of
 * its tree: `presplit+sah+rotate`. All three are declared by the same struct: a splitter has
 * split() in place of build(), an optimiser declares BB_INPUT_TREE.
 *
 * A builder is one constant struct, `const bb_builder bb_builder_NAME`, in builders/NAME/NAME.c.
 * Its device code lies with it: .cl files, the .clh that they include, and the _shared.h that both
 * sides include. CMake finds the folder; nothing else has to be touched. Outside this tree the same
 * files make a shared object by `bvhbench_add_builder(NAME)`, which exports `bb_plugin`, see
 * BB_PLUGIN.
 */
#ifndef BB_BUILDER_H
#define BB_BUILDER_H

#include "framework/base/options.h"
#include "framework/device/device.h"
#include "framework/device/primitives.h"
#include "framework/scene/scene.h"
#include "framework/tree/references.h"
#include "framework/tree/tree.h"

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

/* Raised whenever this header or the structs it takes in change their layout or meaning. */
enum { BB_ABI_VERSION = 5 };

/* What a builder reads; the clock starts when this is in place. All else of the scene is withheld:
 * it is zero in the scene that the hooks get. Views are withheld, too, since rays follow from them,
 * unless the builder has an option `view` and it is given. Kinds, counts and names are always
 * there.
 *
 * After a splitter, boxes and prim_count are those of its references, which the tree's refs number;
 * the harness puts the primitives in their place. Profile and counts per kind stay the scene's.
 * BB_INPUT_GEOMETRY has no meaning for references: such a builder is not built after a splitter. */
enum {
    BB_INPUT_BOXES = 1u << 0,    /* on_device.boxes; for builders on the host also boxes */
    BB_INPUT_GEOMETRY = 1u << 1, /* vertices and the data of prims: likewise */
    BB_INPUT_TREE = 1u << 2,     /* an optimiser: takes another builder's tree */
    BB_INPUT_PROFILE = 1u << 3, /* bounds and profile: measured by the harness, outside the clock */
};

enum { BB_STAGES_MAX = 4 }; /* of a pipeline */

enum { BB_PHASES_MAX = 16 };

/* Named spans inside a build. Boundaries are exact for work on the host; for work on the device
 * only in builds that the harness makes for the purpose (`exact`), since each boundary then waits
 * for the queue. */
typedef struct bb_phases {
    bb_device *device;
    bool exact;
    bool used_device; /* a boundary saw work on the device */
    uint32_t count;
    int32_t current; /* -1: between phases */
    double started;
    bool outside;      /* the current phase does not count */
    double outside_ms; /* sum of those that don't: taken off the build's time */
    const char *names[BB_PHASES_MAX];
    double ms[BB_PHASES_MAX];
} bb_phases;

/* Ends the current phase and begins `name` (a string constant); NULL only ends. A name may come
 * back: its time adds up. */
bb_status bb_phase(bb_phases *phases, const char *name);

/* The same for a phase that is not the method's work, such as the conversion of a library's own
 * tree: it is recorded, and taken off the build's time. BB_FAILED for builders on the device: there
 * is no clock of theirs to take it off. */
bb_status bb_phase_outside(bb_phases *phases, const char *name);

/* What the harness hands to create(); outlives the object. */
typedef struct bb_builder_context {
    bb_device *device;
    bb_account *account;      /* book all memory here */
    const bb_spec *spec;      /* validated parameters */
    const bb_option *options; /* the builder's own table, for bb_spec_u64() and the like */
    uint64_t seed;            /* of all that is random: the same seed, the same tree */
    uint32_t threads;         /* host threads to use */
} bb_builder_context;

typedef struct bb_builder bb_builder;
struct bb_builder {
    uint32_t abi_version; /* BB_ABI_VERSION. Required. */
    const char *name;     /* lower case, digits, '-'; the folder's name. Required. */
    const char *summary;  /* one line for `list`. Required. */
    const char *paper;    /* what it implements, with section. Required ("none" for none). */
    uint32_t kinds;  /* primitive kinds it takes: BB_TRIANGLES | ..., or BB_ALL_KINDS. Required. */
    uint32_t inputs; /* BB_INPUT_...; Required. */
    bb_place place;  /* where its tree is made. Required. */
    /* Same input, same tree, bit for bit. Required to be true; false is an exception that the
     * summary explains and `check` reports. */
    bool deterministic;
    const bb_option *options; /* ends with name NULL. Optional. */
    /* What `run` compares when no builder is asked for: specifications by commas. Optional: default
     * the name alone, beside a builder that makes it whole (pipeline.h); "" leaves the builder
     * out. */
    const char *compared;

    /* Compiles and allocates what does not depend on the scene; not timed. Called once per object,
     * `self` is handed to the other hooks. Required. */
    bb_status (*create)(const bb_builder_context *context, void **self);

    /* Allocates for this scene what build() will need, so that build() does not. Called before the
     * first build of a scene, and of another number of references; not part of the build's time,
     * but recorded. `tree` is NULL for a splitter. Optional: default none. */
    bb_status (*prepare)(void *self, const bb_scene *scene, bb_tree *tree);

    /* Fills `tree` from the declared input, in bb_phase() spans; timed from a finished queue to a
     * finished queue (it need not wait itself). `input` is NULL unless BB_INPUT_TREE: then it is
     * the tree of the stage before, at this builder's `place` (a copy, if it was made on the other
     * side), and stays as it is. Is called many times on the same object. Required, but of a
     * splitter. */
    bb_status (*build)(void *self, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases);

    /* Makes a builder a splitter: fills `references`, in place of build() and timed like it. Each
     * primitive has one or more, whose boxes hold all of it together. Optional. */
    bb_status (*split)(void *self, const bb_scene *scene, bb_references *references,
                       bb_phases *phases);

    /* Brings `tree`, which this object has built, up to date after `changed` (BB_CHANGED_...) of
     * the same primitives; timed like build(), and after restore() like it. A valid tree of what is
     * there now, not the one that build() would make. BB_UNSUPPORTED before it has touched the
     * tree, if it cannot follow: the harness builds again. Not called in a pipeline of several
     * stages. Optional: default, the harness builds again. */
    bb_status (*update)(void *self, const bb_scene *scene, uint32_t changed, bb_tree *tree,
                        bb_phases *phases);

    /* Restores what build() may have used up of its input, before each build or update; not part of
     * the build's time, but recorded. Optional: default none. */
    bb_status (*restore)(void *self, const bb_scene *scene);

    /* Says in one line, without a newline, what there is to know of the last build beyond its
     * figures, such as the bit layout of a code or the level that was chosen; for the record. Not
     * timed. Optional: default nothing. */
    bb_status (*describe)(void *self, const bb_scene *scene, char *text, size_t capacity);

    /* Frees everything; called once, also after a failed build. Required. */
    void (*destroy)(void *self);
};

/* A builder and its device files, as the registry takes them: what a shared object exports. */
typedef struct bb_registration {
    char magic[8]; /* BB_PLUGIN_MAGIC, without a 0: another's bb_plugin says something else */
    uint32_t abi_version; /* BB_ABI_VERSION */
    uint32_t bytes;       /* of this struct */
    const bb_builder *builder;
    const bb_source *files; /* of its folder; ends with name NULL. NULL: none */
} bb_registration;

#define BB_PLUGIN_MAGIC "BVHBPLUG"

/* Exports a builder from a shared object. bvhbench_add_builder() writes this line; a plug-in made
 * by other means has it at the end of its NAME.c. */
#define BB_PLUGIN(builder, files)                                                                  \
    extern const bb_registration bb_plugin;                                                        \
    __attribute__((visibility("default"))) const bb_registration bb_plugin = {                     \
        BB_PLUGIN_MAGIC, BB_ABI_VERSION, sizeof(bb_registration), &(builder), (files)}

/* The reference rows' name: Embree with its own trees. No builder may take it. */
#define BB_REFERENCE_NAME "embree-native"

/* What a builder is in a pipeline: a splitter, an optimiser, or neither. */
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
