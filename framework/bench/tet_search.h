/* How tetrahedra are searched: by a layout of a tree, or one after the other; what kernels that
 * include kernels/locate.clh are told of it. */
#ifndef BB_TET_SEARCH_H
#define BB_TET_SEARCH_H

#include "framework/scene/tets.h"
#include "framework/simulate/simulate.h"
#include "traversal/traversal.h"

/* ---- choosing ---- */

/* A layout that can be searched; those with cells take `boundary=no`, to search without what cells
 * say of the mesh's boundary. BB_INVALID for anything else. */
extern const bb_option bb_tet_search_options[];
bb_status bb_tet_search_parse(const char *text, bb_spec *spec);

/* Of a specification that was parsed. */
bool bb_tet_search_by_boundary(const bb_spec *spec);

/* ---- what is searched ---- */

enum { BB_TET_SEARCH_ARGS = 11, BB_TET_COUNT_ARGS = 4, BB_TET_GROUP = 64 };

/* One scene's tetrahedra by one way. It must not move once args were asked for. */
typedef struct bb_tet_search {
    bb_tet_search_way way;
    const bb_scene *scene;   /* on the device */
    const bb_layout *layout; /* NULL: one tetrahedron after the other, of `list` */
    const bb_layout_data *data;
    const bb_buffer *list;
    bb_prim_ends ends;
    bb_locate_args args;
    const bb_recording *recording; /* gets the steps, with counts; NULL: they are not recorded */
} bb_tet_search;

/* Whether cells say if they list a primitive of the mesh's boundary. */
bool bb_tet_search_has_boundary(bb_tet_search_way way);

/* BB_UNSUPPORTED for other layouts. */
bb_status bb_tet_search_by(const bb_scene *scene, const bb_layout *layout,
                           const bb_layout_data *data, bb_tet_search *search);

/* All of them, without a tree: made once per scene into `list`, which the caller owns. */
bb_status bb_tet_list_make(const bb_scene *scene, bb_buffer *list);
void bb_tet_search_all(const bb_scene *scene, const bb_buffer *list, bb_tet_search *search);

/* The first arguments of a kernel, BB_LOCATE_PARAMETERS in kernels/locate.clh. Their number. */
uint32_t bb_tet_search_args(const bb_tet_search *search, bb_arg args[BB_TET_SEARCH_ARGS]);

/* The last arguments: `counts`, unless NULL, and what is recorded. Their number. */
uint32_t bb_tet_count_args(const bb_tet_search *search, const bb_buffer *counts,
                           bb_arg args[BB_TET_COUNT_ARGS]);

/* What the steps of a search read. BB_UNSUPPORTED if steps cannot name all of it. `kernel`: the
 * name of the kernel that searches; `by_boundary`: bb_tet_search_by_boundary(). To be released,
 * also after a failure, before the scene. */
bb_status bb_tet_search_code(const bb_tet_search *search, const char *kernel, bool by_boundary,
                             bb_simulated_code *code);

/* ---- kernels ---- */

typedef enum bb_tet_counting {
    BB_TET_PLAIN,
    BB_TET_COUNTING,
    BB_TET_RECORDING,
    BB_TET_VARIANTS
} bb_tet_counting;

/* The variants of a kernel that searches, compiled as they are asked for. */
typedef struct bb_tet_kernels {
    const char *source, *name; /* of the file and of the kernel in it */
    const char *option;        /* a macro of the file's own, 0 or 1; NULL: none */
    bool floats;               /* as on a device that has no doubles */
    cl_program programs[BB_SEARCH_WAYS][2][BB_TET_VARIANTS];
    cl_kernel kernels[BB_SEARCH_WAYS][2][BB_TET_VARIANTS]; /* by way, option, counting */
} bb_tet_kernels;

bb_status bb_tet_kernels_get(bb_tet_kernels *kernels, bb_device *device, bb_tet_search_way way,
                             bool option, bb_tet_counting counting, cl_kernel *kernel);
/* The variant for a question with these counts, which may be NULL. */
bb_tet_counting bb_tet_counting_for(const bb_tet_search *search, const bb_buffer *counts);
void bb_tet_kernels_release(bb_tet_kernels *kernels);

bool bb_device_has_doubles(const bb_device *device);

#endif
