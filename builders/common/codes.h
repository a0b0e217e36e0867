/* Morton codes and extended Morton codes, for any builder that sorts by a code.
 *
 * A code is a list that says of each bit, from the top, which axis it halves the cell along, or
 * that it separates large primitives from small ones (Vinkler, Bittner, Havran 2017, "Extended
 * Morton Codes for High Performance Bounding Volume Hierarchy Construction", section 4). A code is
 * a row of BB_CODE_TABLE and the function that deals out its bits; the row has the defaults of its
 * ingredients, each of which is also an option.
 */
#ifndef BB_CODES_H
#define BB_CODES_H

#include "builders/common/code_shared.h"
#include "builders/common/view_order.h"
#include "framework/base/decision.h"
#include "framework/builder/builder.h"

#include <stdbool.h>

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

/* Columns: name, function that deals out the bits, bits, axes, size bit every, most size bits,
 * sizes, summary. */
#define BB_CODE_TABLE(ROW)                                                                         \
    ROW("mc32", interleaved, 30, XYZ, 0, 0, LINEAR, "Morton code of 10 bits per axis")             \
    ROW("mc64", interleaved, 63, XYZ, 0, 0, LINEAR, "Morton code of 21 bits per axis")             \
    ROW("emc32-sort", interleaved, 32, EXTENT, 4, 8, LINEAR, "axes by extent, size every 4th")     \
    ROW("emc64-sort", interleaved, 64, EXTENT, 4, 16, LINEAR, "axes by extent, size every 4th")    \
    ROW("emc32-var", longest, 32, EXTENT, 7, 4, ROOT, "bits to the longest axis, size every 7th")  \
    ROW("emc64-var", longest, 64, EXTENT, 7, 6, ROOT, "bits to the longest axis, size every 7th")  \
    ROW("emc64-cell", halved, 64, EXTENT, 0, 16, CELL, "as var, size at each halving of the cell")

#define BB_CODE_WORD(name, ...) "|" name
#define BB_CODE_NAMES (&(BB_CODE_TABLE(BB_CODE_WORD))[1])

#define BB_CODE_BITS_HELP "bits of the code, 3 to 64; auto: as many as lower the cost"
#define BB_CODE_SIZE_BITS_HELP                                                                     \
    "most size bits, 0 to 24; auto: down to the median primitive, none if all are of a size"

#define BB_CODE_BOX_HELP "box to divide; cube: with the scene's longest side, from its lower corner"

/* Options of codes for a builder's table, which may have only some of them. An option without a
 * default takes it from the code. */
#define BB_CODE_OPTIONS(preset)                                                                    \
    {"code", preset, BB_CODE_NAMES, "code; it sets the defaults of the options below"},            \
        {"bits", NULL, NULL, BB_CODE_BITS_HELP},                                                   \
        {"axes", NULL, "xyz|extent|view", "order of the axes; view: by the view's direction"},     \
        {"count", NULL, "equal|variable", "bits per axis; variable: most for the longest side"},   \
        {"every", NULL, NULL, "every N-th bit encodes the size, 2 to 64; 0: none"},                \
        {"size-bits", NULL, NULL, BB_CODE_SIZE_BITS_HELP},                                         \
        {"size", NULL, "linear|root|cell",                                                         \
         "how size is encoded: relative to the scene's, its "                                      \
         "square root, or relative to the cell's"},                                                \
        {"large", "1", NULL, "size=cell: ratio to the cell's size from which the bit is set"},     \
        {"measure", "diagonal", "diagonal|area|side",                                              \
         "measure of size: the box's diagonal, area or longest side"},                             \
        {"box", "centroids", "centroids|scene|cube", BB_CODE_BOX_HELP},                            \
        {"expand", "shifts", "shifts|tables", "how bits are spread; the code is the same"},        \
    {                                                                                              \
        "view", "none", NULL, BB_VIEW_ORDER_HELP                                                   \
    }

enum { BB_CODE_BITS_MAX = 64, BB_CODE_SIZE_AXIS = 3, BB_CODE_END = 4, BB_CODE_TEXT = 96 };

struct bb_code_walk;

typedef enum bb_code_order { BB_AXES_XYZ, BB_AXES_EXTENT, BB_AXES_VIEW } bb_code_order;
typedef enum bb_code_sizes { BB_SIZES_LINEAR, BB_SIZES_ROOT, BB_SIZES_CELL } bb_code_sizes;

typedef enum bb_code_measure { BB_BY_DIAGONAL, BB_BY_AREA, BB_BY_SIDE } bb_code_measure;

/* The parsed options. */
typedef struct bb_code_choice {
    const struct bb_code *code;
    uint32_t (*next)(const struct bb_code_walk *walk); /* deals out the bits */
    uint32_t bits;
    bb_code_order order;
    uint32_t every, size_bits;
    bb_decider bits_by, size_bits_by; /* BB_BY_SCENE: `auto`, until bb_code_resolve() */
    bb_code_sizes sizes;
    double large; /* BB_SIZES_CELL: ratio to the cell's size from which a primitive is large */
    bb_code_measure measure;
    bool by_centroids, cube;
    bool tables;
    char view[64]; /* argument of bb_view_order() */
} bb_code_choice;

/* The code laid out for a scene: its description, and what the device needs. */
typedef struct bb_code_pattern {
    uint32_t bits;                     /* bits in use; may be fewer than asked for */
    uint8_t axes[BB_CODE_BITS_MAX];    /* of each bit, from the top: 0 to 2, or BB_CODE_SIZE_AXIS */
    double sides[BB_CODE_BITS_MAX][3]; /* sides of the cell after this bit */
    uint32_t count[4];                 /* bits per axis, and size bits */
    bb_code_plan plan;
} bb_code_pattern;

/* Reads the options. `options` is the builder's table. BB_INVALID if a value is out of range. */
bb_status bb_code_choose(const bb_spec *spec, const bb_option *options, bb_code_choice *choice);

/* Resolves `auto` options by the scene's profile, with a number of bits that is a multiple of
 * `multiple`. BB_FAILED if the profile was withheld: a builder whose table has BB_CODE_OPTIONS
 * declares BB_INPUT_PROFILE. */
bb_status bb_code_resolve(bb_code_choice *choice, const bb_scene *scene, uint32_t multiple,
                          const char *builder);

/* Whether the code has the same bits in every scene. */
bool bb_code_is_fixed(const bb_code_choice *choice);

/* Lays the code out for a scene. `bounds` (bb_reduce_boxes) contain the primitives' boxes and their
 * centroids. `direction` is the view's, zero for none. Cannot fail: an axis without extent gets no
 * bits in a code with variable counts, and a single cell in others. */
void bb_code_lay_out(const bb_code_choice *choice, const bb_box bounds[2],
                     const double direction[3], bb_code_pattern *layout);

/* Writes the layout as letters from the top, "xzxzxyszxy..."; capitals are negated. `capacity` must
 * exceed BB_CODE_BITS_MAX. */
void bb_code_letters(const bb_code_pattern *layout, char *text, size_t capacity);

/* ---- on the device ---- */

typedef struct bb_codes bb_codes;

/* Compiles, unless an option is `auto`. All memory is booked on the account. With `leave_bounds`
 * the bounds may stay on the device: the builder does not read them, nor the pattern's members that
 * depend on them (sides, plan.low, plan.scale). */
bb_status bb_codes_create(const bb_builder_context *context, bool leave_bounds, bb_codes **out);
void bb_codes_destroy(bb_codes *codes); /* NULL is allowed */

/* Resolves `auto` options for this scene (bb_code_resolve) and recompiles if that changes the code.
 * Call it in prepare(), before the sizes below are read. */
bb_status bb_codes_prepare(bb_codes *codes, const bb_scene *scene, uint32_t multiple);
bool bb_codes_ready(const bb_codes *codes); /* no option is still `auto` */

uint32_t bb_codes_bits(const bb_codes *codes);      /* bits of a key that are in use */
uint32_t bb_codes_key_bytes(const bb_codes *codes); /* 4 up to 32 bits, else 8 */

/* Whether kernels must be compiled for another key size: it is known and differs from `compiled`,
 * the bytes per key of the kernels at hand (0: there are none). */
bool bb_codes_key_changed(const bb_codes *codes, uint32_t compiled);

/* Phases "bounds" and "codes": keys[i] = code of the scene's i-th box, values[i] = i. Waits once,
 * for the scene's bounds; not if they may stay on the device, the code has the same bits in every
 * scene and the device supports doubles. Buffers have room for scene->prim_count keys and u32. */
bb_status bb_codes_make(bb_codes *codes, bb_primitives *primitives, const bb_scene *scene,
                        bb_buffer *keys, bb_buffer *values, bb_phases *phases);

/* Appends the decisions on bits and size bits of the last bb_codes_make(). */
void bb_codes_decide(const bb_codes *codes, const bb_scene *scene, bb_decisions *decisions);

/* Writes "code of 30 bits: xyzxyz..." of the last bb_codes_make(), for a builder's describe().
 * BB_CODE_TEXT characters are enough. */
void bb_codes_describe(const bb_codes *codes, char *text, size_t capacity);

/* The pattern of the last bb_codes_make(). */
const bb_code_pattern *bb_codes_pattern(const bb_codes *codes);
/* Two boxes: around the primitives' boxes and around their centroids. Not with `leave_bounds`. */
const bb_box *bb_codes_bounds(const bb_codes *codes);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
