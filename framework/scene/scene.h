/* A scene: primitives of one or more kinds, their boxes, their views; on the host and on the
 * device.
 *
 * Primitives are numbered consecutively: the triangles first, then the spheres, then each further
 * kind. Everything is float, in scene units, as loaded; nothing is merged or dropped.
 */
#ifndef BB_SCENE_H
#define BB_SCENE_H

#include "framework/base/options.h"
#include "framework/device/device.h"
#include "framework/scene/volume.h"
#include "kernels/bb_shared.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

/* Kinds of primitives as bits: BB_TRIANGLES, BB_SPHERES, ... */
enum {
#define BB_KIND_BIT(NAME, name, words, kept) BB_##NAME##S = 1u << BB_##NAME,
    BB_PRIM_KINDS(BB_KIND_BIT)
#undef BB_KIND_BIT
        BB_ALL_KINDS = (1u << BB_KIND_COUNT) - 1,
};

/* Projection and position of a camera. */
typedef struct bb_view {
    char name[48];
    bool parallel; /* parallel projection instead of a pinhole */
    double eye[3];
    double target[3];
    double up[3];
    double fov_y; /* degrees; for a parallel view: height of the picture in scene units */
} bb_view;

enum { BB_VIEWS_MAX = 16 };

enum { BB_BITS_NONE = 65 };

/* Properties of a scene that the harness measures once; views and other choices are derived from
 * them. */
typedef struct bb_profile {
    bool measured;   /* false: withheld; all other members are 0 */
    double flatness; /* shortest / longest side of the scene's box, 0..1 */
    double size_min; /* box diagonals of the primitives: smallest, median, largest */
    double size_median;
    double size_max;
    double size_low;          /* 1 % of the primitives are smaller */
    double size_high;         /* 1 % of the primitives are larger */
    uint32_t zero_area;       /* triangles of exactly zero area, spheres of radius 0 */
    uint32_t duplicate_boxes; /* primitives whose box equals an earlier one's */
    uint32_t duplicate_centroids;
    double overlap;     /* estimated mean number of other boxes that contain a box's centroid */
    int32_t closed;     /* 1: each edge of the triangles has two sides; 0: open; -1: no triangles */
    uint32_t code_bits; /* 30, 32, 63 or 64: the least that separates the centroids; 0: none does */
    uint32_t octree_depth; /* levels that separate the centroids, at most 21 */
    uint32_t bits_apart;   /* 0 .. 64: bits that separate all centroids; BB_BITS_NONE: 64 do not */
    uint32_t bits_useful;  /* 0 .. 64: longer codes hardly lower the cost of a tree */
} bb_profile;

/* Device side of a scene. */
typedef struct bb_scene_device {
    bb_device *device;
    bb_account account;
    bb_buffer boxes;    /* bb_box[prim_count] */
    bb_buffer vertices; /* float[3 * vertex_count] */
    bb_buffer prims;    /* the data of all kinds, one after the other */
    /* of a volume, as in bb_volume */
    bb_buffer bricks;
    bb_buffer ranges;
    bb_buffer seen;
    /* of tetrahedra, as in bb_tets */
    bb_buffer tet_flags;
    bb_buffer field;
} bb_scene_device;

/* Brings a moving scene to another frame: bb_scene_take_motion(). */
struct bb_scene_motion;

/* The primitives of one kind: numbers first .. first + count - 1 of the scene. */
typedef struct bb_prims {
    uint32_t first, count;
    uint32_t room; /* reserved number: the most that a moving scene has */
    /* triangles: u32[3 * count], indices of vertices; spheres: float[4 * count], centre and
     * radius >= 0; boxes: float[6 * count], lower and upper corner; tetrahedra: u32[4 * count],
     * indices of vertices */
    void *data;
} bb_prims;

/* Number of primitives of each kind. */
typedef struct bb_prim_counts {
    uint64_t of[BB_KIND_COUNT];
} bb_prim_counts;

typedef struct bb_scene {
    char name[256];                /* the specification: what records and tables show */
    char source[64];               /* "glTF" or the generator's name */
    uint32_t kinds;                /* kinds that it has, as bits */
    uint32_t prim_count;           /* of all kinds, 1 .. 2^31 - 1; 0: see bb_scene_load_any() */
    bb_prims prims[BB_KIND_COUNT]; /* by kind: BB_TRIANGLE, ... */
    uint32_t vertex_count, vertex_room;
    float *vertices; /* x y z; 4 bytes more may be read, as bb_host_alloc() lets */
    bb_box *boxes;   /* of the primitives, tight: a sphere's is rounded outwards; no -0 */
    bb_box bounds;
    float scale; /* power of two by which layouts multiply lengths: see bb_scene_choose_scale() */
    uint32_t out_of_range; /* primitives too small beside the scene for the kernels' floats */
    uint64_t hash;         /* of the geometry, XXH3 */
    uint32_t ignored;      /* parts of the file that were skipped: primitives without a surface
                            * (points, lines), animation channels with an unknown target */
    uint32_t view_count;
    bb_view views[BB_VIEWS_MAX];
    bb_profile profile;
    /* a closed mesh with `inside_point` inside (set by generators) */
    bool closed_from_inside;
    double inside_point[3];
    uint32_t frame_count; /* states of a moving scene; 1 if it does not move */
    uint32_t frame;       /* current: bb_scene_set_frame(); BB_NONE: none, after a failure */
    struct bb_scene_motion *motion; /* NULL: it does not move */
    /* NULL: none. Otherwise the primitives are the boxes of the bricks that its transfer function
     * makes visible, in the order of the bricks, and the bounds are the whole volume's.
     */
    bb_volume *volume;
    uint32_t *bricks; /* of a volume: brick of each primitive */
    /* Things that move as one: object i has the primitives from object_starts[i] up to, but not
     * including, object_starts[i + 1]. 0: the scene does not say. */
    uint32_t object_count;
    uint32_t *object_starts;
    /* The objects that move, in ascending order; all others never do. 0: the scene does not say. */
    uint32_t mover_count;
    uint32_t *movers;
    struct bb_tets *tets;       /* of tetrahedra: tets.h; NULL: there are none */
    struct bb_scene_seal *seal; /* hashes: bb_scene_seal(); NULL: not taken yet */
    bb_scene_device on_device;
    double load_ms;
} bb_scene;

/* A procedural scene: one constant struct per generator, found in scenes/gen_NAME.c. */
typedef struct bb_generator {
    const char *name;
    const char *summary; /* one line */
    const bb_option *options;
    /* Fills the arrays that bb_scene_reserve() allocated, closed_from_inside, and views if it has
     * fixed ones. bb_scene_finish() does the rest (boxes, bounds, hash, checks). */
    bb_status (*make)(const bb_spec *spec, const bb_option *options, bb_scene *scene);
    /* Rewrites the vertices, or the data of primitives without vertices, to those of `frame`, 0 ..
     * frame_count - 1, whichever frame is current. Counts may change, within the reserved room;
     * indices stay the same, so if there are fewer primitives they are the first ones. make() has
     * set frame_count and made frame 0, bit for bit the same as this function. Views and profile
     * describe frame 0; closed_from_inside is set only if it holds for all frames. Optional:
     * without it, the scene does not move. */
    bb_status (*set_frame)(const bb_spec *spec, const bb_option *options, bb_scene *scene,
                           uint32_t frame);
} bb_generator;

extern const bb_generator *const bb_generators[]; /* generated table; ends with NULL */

/* A format of scene files: scenes/format_NAME.c, which CMake finds. */
typedef struct bb_scene_format {
    const char *name;           /* as named in records */
    const char *const *endings; /* file name endings, in lower case with the dot; ends with NULL */
    /* Reads the file's primitives into the scene; bb_scene_finish() follows. `spec` has the given
     * `options`. If the file moves: frame 0, after bb_scene_take_motion(). BB_INVALID for a bad
     * file. */
    bb_status (*load)(const char *path, const bb_spec *spec, bb_scene *scene);
    const bb_option *options; /* that may follow a file's name; NULL: none */
} bb_scene_format;

extern const bb_scene_format *const bb_scene_formats[]; /* generated table; ends with NULL */

/* Loads the scene that `text` names: an existing file (.gltf, .glb, ...), optionally with options
 * after its name (FILE:key=value), a shipped scene (coffee, scorpion, ...: see bb_shipped_scenes),
 * or a generator with parameters. Finishes it, and takes its views from `NAME.views` beside the
 * file, from the generator, or derived from the profile; derived views follow the file's cameras,
 * if it has any. BB_INVALID, with one clear line, for anything wrong with the input. The caller
 * owns *scene: bb_scene_free(). */
bb_status bb_scene_load(const char *text, bb_scene **scene);
/* The same, but also accepts a volume with nothing visible, which has no primitives. */
bb_status bb_scene_load_any(const char *text, bb_scene **scene);
void bb_scene_free(bb_scene *scene); /* NULL is allowed; releases the device side too */

/* Makes another scene of about `count` of this one's primitives, evenly spaced in their numbers and
 * in equal shares of each kind (at least one of each), with its name, views and profile. It does
 * not move, and has no volume. The caller owns *sample: bb_scene_free(). */
bb_status bb_scene_sample(const bb_scene *scene, uint32_t count, bb_scene **sample);

/* Sets counts and kinds of an empty scene and allocates its vertices and primitives, without
 * clearing them; for loaders and generators. BB_REFUSED, with the bytes that the scene needs, if it
 * has more than 2^31 - 1 primitives or 2^32 - 1 vertices, or does not fit into the host's
 * memory. */
bb_status bb_scene_reserve(bb_scene *scene, uint64_t vertex_count, const bb_prim_counts *counts);

/* The same for triangles only. */
bb_status bb_scene_reserve_mesh(bb_scene *scene, uint64_t vertex_count, uint64_t triangle_count);
/* For generators: allocates the scene's objects, object_starts with one entry more than there are,
 * and a list of those that move, to be filled. */
bb_status bb_scene_reserve_objects(bb_scene *scene, uint32_t objects, uint32_t movers);

/* Checks a filled scene (finite, indices in range, at least one primitive), turns every -0 into +0,
 * and computes boxes, bounds, scale and hash. */
bb_status bb_scene_finish(bb_scene *scene);

/* Kinds of change between two states of a scene. */
enum {
    BB_CHANGED_POSITIONS = 1u << 0,
    BB_CHANGED_TOPOLOGY = 1u << 1,
    BB_CHANGED_TRANSFER = 1u << 2, /* the transfer function of a volume */
};

/* Brings the scene to `frame`, in place: vertices, data of primitives, boxes, bounds, scale,
 * out_of_range and hash become that frame's, and so does the copy on the device, if there is one
 * (waited for). Profile, views and closed_from_inside remain those of frame 0: cameras do not move,
 * and choices based on the profile are made once. Frame 0 equals the loaded scene, bit for bit.
 * `changed` gets BB_CHANGED_POSITIONS, plus BB_CHANGED_TOPOLOGY if the number of primitives
 * changed, or 0 if nothing moved; may be NULL. BB_INVALID if there is no such frame: the scene is
 * unchanged. After any other failure the scene is at no frame until a call succeeds, which then
 * reports both. */
bb_status bb_scene_set_frame(bb_scene *scene, uint32_t frame, uint32_t *changed);

/* Rewrites the vertices, or the data of primitives without vertices, to those of `frame`, 0 ..
 * frame_count - 1, whichever frame is current; counts may change, within the reserved room. Frame 0
 * must equal the loaded scene, bit for bit. */
typedef bb_status (*bb_scene_pose)(void *data, bb_scene *scene, uint32_t frame);

/* For loaders: makes the scene move in `frame_count` frames, which `pose` makes from `data`. The
 * scene owns `data` from now on, even after a failure, and passes it to `release`. */
bb_status bb_scene_take_motion(bb_scene *scene, uint32_t frame_count, bb_scene_pose pose,
                               void (*release)(void *data), void *data);

/* For loaders and generators: makes the scene that of a volume, which the scene owns from now
 * on. */
bb_status bb_scene_take_volume(bb_scene *scene, bb_volume *volume, const bb_transfer *transfer);

/* Gives the scene's volume another transfer function. Its primitives become the bricks that this
 * makes visible, also on the device if the scene is there (waited for). Profile and hash follow,
 * views and bounds stay. There may then be no primitives. `changed` gets BB_CHANGED_TRANSFER.
 * BB_INVALID if there is no volume. */
bb_status bb_scene_set_transfer(bb_scene *scene, const bb_transfer *transfer, uint32_t *changed);

/* Sets scene->scale and scene->out_of_range from its primitives and bounds; called by
 * bb_scene_finish().
 *
 * The kernels' edge functions are products of two lengths. They keep their sign if twice the area
 * of a triangle (for a sphere, its radius squared) is at least 2^-100 and lengths are at most 2^60,
 * in the layout's units. The scale brings the scene's largest coordinate to about 2^32, or up to
 * 2^58 if the smallest primitive requires it. Primitives that are too small even then are counted:
 * rays may miss them. BB_INVALID if the largest coordinate is below 2^-100. */
bb_status bb_scene_choose_scale(bb_scene *scene);

/* Measures scene->profile; called by bb_scene_load(). */
bb_status bb_scene_profile(bb_scene *scene);

/* Adds a view called `name`, shortened, with '-' replacing all but letters, digits, '.' and '_',
 * and with a number if another view has that name. Does nothing if there are already
 * BB_VIEWS_MAX. */
void bb_scene_add_view(bb_scene *scene, const char *name, const bb_view *view);

/* Derives three or more named views from box and profile, deterministically. Does nothing if the
 * scene has views. */
void bb_scene_derive_views(bb_scene *scene);

/* Reads views from a text file (format: scenes/README.md). */
bb_status bb_views_read(const char *path, bb_view *views, uint32_t capacity, uint32_t *count);

/* Refuses, with the bytes needed, a scene whose copy does not fit on the device. */
bb_status bb_scene_has_room(bb_scene *scene, const bb_device *device);

/* Copies the scene to the device (once; a second call with the same device does nothing) and
 * computes its boxes there. Refused as bb_scene_has_room() says. */
bb_status bb_scene_upload(bb_scene *scene, bb_device *device);

/* Computes on_device.boxes from the geometry on the device (kernels/boxes.cl). Enqueued, not waited
 * for. */
bb_status bb_scene_make_boxes(bb_scene *scene);

/* Names of the shipped scenes, ending with NULL, and their folder: the first that exists of
 * BVHBENCH_SCENES in the environment, the share folder of the library's installation, and the
 * source tree. */
extern const char *const bb_shipped_scenes[];
const char *bb_scene_folder(void);

/* Returns the ends of the kinds' numbers, for device code. */
bb_prim_ends bb_scene_ends(const bb_scene *scene);

static inline uint32_t *bb_scene_indices(const bb_scene *scene)
{
    return (uint32_t *)scene->prims[BB_TRIANGLE].data;
}

/* Returns the data of a kind that consists of floats. */
static inline float *bb_scene_floats(const bb_scene *scene, uint32_t kind)
{
    return (float *)scene->prims[kind].data;
}

/* Returns vertex `corner` of triangle `triangle`, as a pointer into scene->vertices. */
static inline const float *bb_scene_vertex(const bb_scene *scene, uint32_t triangle,
                                           uint32_t corner)
{
    return scene->vertices + 3 * (size_t)bb_scene_indices(scene)[3 * (size_t)triangle + corner];
}

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
