/* Trees and layouts on the device. They are made on demand, and evicted if they do not fit beside
 * each other. Who asks for a layout need not know that it may take a build. */
#ifndef BB_RESIDENT_H
#define BB_RESIDENT_H

#include "framework/builder/instance.h"
#include "framework/record/record.h"
#include "traversal/traversal.h"

/* A layout of leaves with up to `leaf` references and triangles in one form; all kernels and
 * intersectors that read it share it. */
typedef struct bb_layout_choice {
    const bb_layout *layout;
    bb_layout_wish wish;
    bb_layout_maker maker; /* created when it is needed; it holds memory */
    uint32_t leaf;
    uint32_t format; /* BB_FORMAT_... */
} bb_layout_choice;

/* A builder on a scene: what it has in memory now. It must not move while it has anything. */
typedef struct bb_resident {
    const char *text; /* specification */
    bb_scene *scene;
    bb_instance instance; /* alive while instance.pipeline.count > 0 */
    bool built;           /* instance.tree holds a tree */
    bool pinned;          /* it is used together with others, and is not evicted for them */
    bool compiled;        /* its kernels have run before */
    double cold_ms;       /* time of the first build, on fresh memory; 0: not built yet */
    bool checked;         /* its tree was checked; one that is built again must be like it: */
    bb_tree_info tree;
    bb_layout_data layouts[BB_LAYOUTS_MAX];
    bool has_layout[BB_LAYOUTS_MAX];
    bool keeps_shape[BB_LAYOUTS_MAX]; /* the layout has the tree's shape; known once it was made */
} bb_resident;

typedef struct bb_residency {
    bb_device *device;
    uint64_t seed; /* of builders */
    bb_resident *items;
    uint32_t count;
    bb_layout_choice layouts[BB_LAYOUTS_MAX];
    uint32_t layout_count;
    uint64_t bytes_held; /* most that all held at a time, by their accounts */
    /* Asked for room when there is nothing left to evict: returns whether it freed anything. NULL:
     * there is nobody to ask. */
    bool (*give_up)(void *whom);
    void *whom;
} bb_residency;

/* Finds the layout that a kernel of this specification reads, or adds it. BB_INVALID if there are
 * too many. */
bb_status bb_residency_layout(bb_residency *all, const bb_layout *layout,
                              const bb_layout_wish *wish, uint32_t leaf, uint32_t format,
                              uint32_t *index);

/* Frees what makes layouts, after all residents were evicted. */
void bb_residency_end(bb_residency *all);

/* Pins `count` residents, from `first` on, and no others. What is pinned stays when there is no
 * room: only its layouts make room, all of them for a tree, all but one kind for a layout. So trees
 * that are used together are all made before their layouts. */
void bb_residency_pin(bb_residency *all, bb_resident *first, uint32_t count);

/* Frees what others have, and all layouts, for other needs of `keep`, whose tree stays (NULL: of
 * nobody). Returns false if there was nothing to free. */
bool bb_residency_make_room(bb_residency *all, const bb_resident *keep);

/* Makes sure that the tree exists. If it does not fit beside the others, they are evicted. */
bb_status bb_resident_tree(bb_residency *all, bb_resident *resident);

/* Builds the tree again, as bb_instance_build() does. If memory is short, others are evicted. After
 * a failure the tree is gone. */
bb_status bb_resident_build(bb_residency *all, bb_resident *resident, bool exact,
                            bb_build_timing *timing);

/* The same of a tree that exists, without another attempt: what is built in a second one is not new
 * to the builder. */
bb_status bb_resident_build_once(bb_resident *resident, bb_build_timing *timing);

/* Makes sure that a tree that exists is on the device, as bb_tree_upload() does. If it does not fit
 * beside the others, they are evicted. */
bb_status bb_resident_upload(bb_residency *all, bb_resident *resident, double *ms);

/* Makes sure that the layout is on the device. If memory is short, others are evicted. BB_FAILED
 * if a tree that was built again has another shape than the one that was checked. */
bb_status bb_resident_layout(bb_residency *all, bb_resident *resident, uint32_t layout);

/* Makes an existing layout again in its place. If memory is short, others are evicted. After a
 * failure the layout is gone. */
bb_status bb_resident_layout_again(bb_residency *all, bb_resident *resident, uint32_t layout);

/* Checks the tree (bb_tree_check()), on the host, where a copy of it then lies. */
bb_status bb_resident_check(bb_resident *resident);

/* Raises bytes_held to what all hold now or held since their accounts were marked. */
void bb_residency_note(bb_residency *all);

/* Frees the tree and all that its builder holds; layouts stay. The tree is built again when
 * somebody asks for it. Returns whether there was anything to free. */
bool bb_resident_free_tree(bb_resident *resident);

/* The same, and frees the layouts. */
bool bb_resident_evict(bb_resident *resident);

#endif
