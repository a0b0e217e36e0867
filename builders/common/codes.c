/* Lays codes out for a scene: the meaning of each bit, and the plan by which the device makes
 * keys. */
#include "builders/common/codes.h"

#include "framework/scene/needs.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* More bits than a float's mantissa separate nothing. */
enum { AXIS_BITS_MAX = 24 };

/* The state while bits are dealt out, from the top. */
struct bb_code_walk {
    const bb_code_choice *choice;
    uint32_t order[3]; /* axes, first to last */
    double side[3];    /* sides of the cell after the bits so far */
    uint32_t count[4]; /* bits so far, per axis and size bits */
    uint32_t bit;      /* bits so far */
};
typedef struct bb_code_walk walk;

/* The axis that the next bit halves, BB_CODE_SIZE_AXIS for a size bit, or BB_CODE_END. */
typedef uint32_t next_axis(const walk *w);

struct bb_code {
    const char *name;
    next_axis *next;
    uint32_t bits;
    bb_code_order order;
    uint32_t every, size_bits;
    bb_code_sizes sizes;
};
typedef struct bb_code bb_code;

static bool is_size_bit(const walk *w)
{
    const bb_code_choice *c = w->choice;
    return c->every > 0 && (w->bit + 1) % c->every == 0 &&
           w->count[BB_CODE_SIZE_AXIS] < c->size_bits;
}

/* Takes the axes in turn. */
static uint32_t interleaved(const walk *w)
{
    if (is_size_bit(w))
        return BB_CODE_SIZE_AXIS;
    uint32_t turn = w->bit - w->count[BB_CODE_SIZE_AXIS];
    uint32_t axis = w->order[turn % 3];
    return w->count[axis] < AXIS_BITS_MAX ? axis : BB_CODE_END;
}

/* Halves the longest side of the cell (Vinkler et al. 2017, section 4.4 and algorithm 2, without
 * its shifts by 3, 2, 1, 0, which belong to algorithm 1). An axis without extent gets no bits. */
static uint32_t longest(const walk *w)
{
    if (is_size_bit(w))
        return BB_CODE_SIZE_AXIS;
    uint32_t found = BB_CODE_END;
    for (uint32_t i = 0; i < 3; i++) {
        uint32_t axis = w->order[i];
        if (w->side[axis] > 0 && w->count[axis] < AXIS_BITS_MAX &&
            (found == BB_CODE_END || w->side[axis] > w->side[found]))
            found = axis;
    }
    return found;
}

/* Like `longest`, with a size bit after each halving of the cell's longest side: after three bits
 * while the cell is a cube, after two while it is flat. So a primitive that a size bit separates is
 * equally large relative to its cell in all scenes. */
static uint32_t halved(const walk *w)
{
    double now = 0, whole = 0;
    for (uint32_t k = 0; k < 3; k++) {
        now = fmax(now, w->side[k]);
        whole = fmax(whole, ldexp(w->side[k], (int)w->count[k]));
    }
    uint32_t sizes = w->count[BB_CODE_SIZE_AXIS];
    if (sizes < w->choice->size_bits && now > 0 && now <= ldexp(whole, -(int)(sizes + 1)))
        return BB_CODE_SIZE_AXIS;
    return longest(w);
}

/* ---- the table ---- */

#define CODE_ROW(name, next, bits, order, every, size_bits, sizes, summary)                        \
    {name, next, bits, BB_AXES_##order, every, size_bits, BB_SIZES_##sizes},
static const bb_code codes[] = {BB_CODE_TABLE(CODE_ROW)};

static const bb_code *find_code(const char *name)
{
    for (size_t i = 0; i < sizeof codes / sizeof codes[0]; i++)
        if (strcmp(codes[i].name, name) == 0)
            return &codes[i];
    return NULL;
}

/* Reads a number; the code's own stays if the option is not given. `by` is NULL if `auto` is not
 * allowed. */
static bb_status read_number(const bb_spec *spec, const bb_option *options, const char *key,
                             uint64_t low, uint64_t high, uint32_t *value, bb_decider *by)
{
    uint64_t number;
    if (bb_spec_value(spec, options, key) == NULL)
        return BB_OK;
    if (by != NULL && bb_spec_is(spec, options, key, "auto")) {
        *by = BB_BY_SCENE;
        return BB_OK;
    }
    BB_TRY(bb_spec_u64(spec, options, key, low, high, &number));
    *value = (uint32_t)number;
    if (by != NULL)
        *by = BB_GIVEN;
    return BB_OK;
}

bb_status bb_code_choose(const bb_spec *spec, const bb_option *options, bb_code_choice *choice)
{
    const bb_code *code = find_code(bb_spec_value(spec, options, "code"));
    if (code == NULL)
        return bb_fail(BB_FAILED, "builder %s: its default code is none of %s", spec->name,
                       BB_CODE_NAMES);
    *choice = (bb_code_choice){.code = code,
                               .bits = code->bits,
                               .order = code->order,
                               .every = code->every,
                               .size_bits = code->size_bits,
                               .sizes = code->sizes,
                               .next = code->next};
    BB_TRY(
        read_number(spec, options, "bits", 3, BB_CODE_BITS_MAX, &choice->bits, &choice->bits_by));
    BB_TRY(read_number(spec, options, "every", 0, BB_CODE_BITS_MAX, &choice->every, NULL));
    BB_TRY(read_number(spec, options, "size-bits", 0, AXIS_BITS_MAX, &choice->size_bits,
                       &choice->size_bits_by));
    if (choice->every == 1)
        return bb_fail(BB_INVALID, "builder %s: option 'every' is 1, must be 0 or 2 to %d",
                       spec->name, BB_CODE_BITS_MAX);
    const char *count = bb_spec_value(spec, options, "count");
    if (count != NULL)
        choice->next = strcmp(count, "variable") == 0 ? longest : interleaved;
    const char *view = bb_spec_value(spec, options, "view");
    if (strlen(view) >= sizeof choice->view)
        return bb_fail(BB_INVALID, "builder %s: option 'view' is longer than %zu characters",
                       spec->name, sizeof choice->view - 1);
    strcpy(choice->view, view);
    const char *axes = bb_spec_value(spec, options, "axes");
    if (axes != NULL)
        choice->order = strcmp(axes, "xyz") == 0      ? BB_AXES_XYZ
                        : strcmp(axes, "extent") == 0 ? BB_AXES_EXTENT
                                                      : BB_AXES_VIEW;
    else if (strcmp(view, "none") != 0)
        choice->order = BB_AXES_VIEW;
    if (choice->order == BB_AXES_VIEW && strcmp(view, "none") == 0)
        return bb_fail(BB_INVALID, "builder %s: axes=view needs a view=...", spec->name);
    const char *sizes = bb_spec_value(spec, options, "size");
    if (sizes != NULL)
        choice->sizes = strcmp(sizes, "linear") == 0 ? BB_SIZES_LINEAR
                        : strcmp(sizes, "root") == 0 ? BB_SIZES_ROOT
                                                     : BB_SIZES_CELL;
    choice->large = 1;
    if (bb_spec_value(spec, options, "large") != NULL)
        BB_TRY(bb_spec_double(spec, options, "large", 1e-3, 1e3, &choice->large));
    choice->measure = bb_spec_is(spec, options, "measure", "area")   ? BB_BY_AREA
                      : bb_spec_is(spec, options, "measure", "side") ? BB_BY_SIDE
                                                                     : BB_BY_DIAGONAL;
    choice->by_centroids = bb_spec_is(spec, options, "box", "centroids");
    choice->cube = bb_spec_is(spec, options, "box", "cube");
    choice->tables = bb_spec_is(spec, options, "expand", "tables");
    return BB_OK;
}

/* ---- what the scene decides ---- */

/* A bit of the square root of the size stands for two octaves. */
static uint32_t size_bits_for(const bb_code_choice *choice, uint32_t octaves)
{
    uint32_t bits = choice->sizes == BB_SIZES_ROOT ? (octaves + 1) / 2 : octaves;
    return bits < AXIS_BITS_MAX ? bits : AXIS_BITS_MAX;
}

/* Size bits among the first `bits` of the code. With a size bit at each halving of the cell, about
 * every fourth bit is one. */
static uint32_t size_bits_among(const bb_code_choice *choice, uint32_t bits)
{
    uint32_t every = choice->next == halved ? 4 : choice->every;
    uint32_t count = every > 0 ? bits / every : 0;
    return count < choice->size_bits ? count : choice->size_bits;
}

bb_status bb_code_resolve(bb_code_choice *choice, const bb_scene *scene, uint32_t multiple,
                          const char *builder)
{
    char what[96];
    if (choice->bits_by != BB_BY_SCENE && choice->size_bits_by != BB_BY_SCENE)
        return BB_OK;
    snprintf(what, sizeof what, "builder %s: %s=auto", builder,
             choice->bits_by == BB_BY_SCENE ? "bits" : "size-bits");
    BB_TRY(bb_needs_check(scene, what));
    if (choice->size_bits_by == BB_BY_SCENE)
        choice->size_bits = size_bits_for(choice, bb_need_size_octaves(scene));
    if (choice->bits_by != BB_BY_SCENE)
        return BB_OK;
    uint32_t places = bb_need_code_bits(scene), most = BB_CODE_BITS_MAX / multiple * multiple;
    choice->bits = places;
    while (choice->bits < most && (choice->bits - size_bits_among(choice, choice->bits) < places ||
                                   choice->bits % multiple != 0))
        choice->bits++;
    choice->bits = choice->bits < most ? choice->bits : most;
    return BB_OK;
}

/* ---- layout ---- */

static void order_axes(walk *w, const double direction[3])
{
    const double none[3] = {0, 0, 0};
    const double *key = w->choice->order == BB_AXES_XYZ      ? none
                        : w->choice->order == BB_AXES_EXTENT ? w->side
                                                             : direction;
    bb_axis_order order = bb_axis_order_of(key);
    memcpy(w->order, order.axis, sizeof w->order);
}

static void deal_bits(walk *w, bb_code_pattern *layout)
{
    while (w->bit < w->choice->bits) {
        uint32_t axis = w->choice->next(w);
        if (axis == BB_CODE_END)
            break;
        if (axis != BB_CODE_SIZE_AXIS)
            w->side[axis] *= 0.5;
        w->count[axis]++;
        layout->axes[w->bit] = (uint8_t)axis;
        memcpy(layout->sides[w->bit], w->side, sizeof w->side);
        w->bit++;
    }
    layout->bits = w->bit;
    memcpy(layout->count, w->count, sizeof w->count);
}

/* Places of the lane's bits in a key. */
static uint64_t places_of(const bb_code_pattern *layout, uint32_t lane)
{
    uint64_t places = 0;
    for (uint32_t i = 0; i < layout->bits; i++)
        if (layout->axes[i] == lane)
            places |= UINT64_C(1) << (layout->bits - 1 - i);
    return places;
}

/* Plans the moves to those places: bit j, counted from the lowest, travels up to its place in steps
 * of 32, 16 ... 1 ("expand" by parallel moves; Warren, Hacker's Delight). */
static void plan_moves(bb_code_pattern *layout, uint32_t lane)
{
    bb_code_plan *plan = &layout->plan;
    uint64_t left = places_of(layout, lane);
    plan->kept[lane] = left;
    for (uint32_t j = 0; left != 0; j++, left &= left - 1) {
        uint32_t at = j, distance = (uint32_t)__builtin_ctzll(left) - j;
        for (uint32_t step = 0; step < BB_CODE_STEPS; step++) {
            uint32_t move = 32u >> step;
            if ((distance & move) == 0)
                continue;
            at += move;
            plan->moved[lane][step] |= UINT64_C(1) << at;
        }
    }
}

/* 2^bits / extent; 0 if that is infinite or there is nothing to separate. */
static float cells_per_unit(uint32_t bits, double extent)
{
    double scale = ldexp(1.0, (int)bits) / extent;
    return extent > 0 && bits > 0 && scale <= FLT_MAX ? (float)scale : 0.0f;
}

/* Size of a box with these sides, as a length: its diagonal, the square root of its area or its
 * longest side. */
static double size_of(const bb_code_choice *choice, const double side[3])
{
    double x = side[0], y = side[1], z = side[2];
    return choice->measure == BB_BY_AREA   ? sqrt(2 * (x * y + y * z + z * x))
           : choice->measure == BB_BY_SIDE ? fmax(x, fmax(y, z))
                                           : sqrt(x * x + y * y + z * z);
}

/* Plans the size bits. linear: size / scene. root: its square root, since a step of six halvings
 * quarters the cell while one of the code halves the size (section 4.2). cell: 1 if the primitive
 * is at least `large` times as large as the cell after the bits above. Lengths are in units of the
 * scene's longest side. */
static void plan_sizes(const bb_code_choice *choice, bb_code_pattern *layout, double unit,
                       const double whole[3])
{
    bb_code_plan *plan = &layout->plan;
    uint32_t bits = layout->count[BB_CODE_SIZE_AXIS];
    double scaled[3];
    for (uint32_t k = 0; k < 3; k++)
        scaled[k] = whole[k] * unit;
    if (choice->sizes != BB_SIZES_CELL) {
        plan->scale[3] = cells_per_unit(choice->sizes == BB_SIZES_ROOT ? 2 * bits : bits,
                                        size_of(choice, scaled));
        return;
    }
    for (uint32_t i = 0; i < layout->bits && plan->size_count < BB_CODE_SIZES; i++) {
        if (layout->axes[i] != BB_CODE_SIZE_AXIS)
            continue;
        double side[3];
        for (uint32_t k = 0; k < 3; k++)
            side[k] = layout->sides[i][k] * unit;
        double least = choice->large * size_of(choice, side);
        plan->size_least[plan->size_count] = (float)(least * least);
        plan->size_bit[plan->size_count++] = UINT64_C(1) << (layout->bits - 1 - i);
    }
}

bool bb_code_is_fixed(const bb_code_choice *choice)
{
    return choice->next == interleaved && choice->order != BB_AXES_EXTENT && choice->size_bits == 0;
}

void bb_code_lay_out(const bb_code_choice *choice, const bb_box bounds[2],
                     const double direction[3], bb_code_pattern *layout)
{
    const bb_box *box = &bounds[choice->by_centroids ? 1 : 0];
    double whole[3], all = 0;
    walk w = {.choice = choice};
    for (uint32_t k = 0; k < 3; k++) {
        whole[k] = (double)box->hi[k] - box->lo[k];
        all = fmax(all, whole[k]);
    }
    for (uint32_t k = 0; k < 3; k++)
        w.side[k] = whole[k] = choice->cube ? all : whole[k];
    *layout = (bb_code_pattern){0};
    order_axes(&w, direction);
    deal_bits(&w, layout);
    bb_code_plan *plan = &layout->plan;
    uint32_t flips = bb_axis_order_of(direction).flips;
    for (uint32_t lane = 0; lane < 4; lane++) {
        plan->last[lane] = (float)((1u << layout->count[lane]) - 1);
        plan_moves(layout, lane);
        if (lane == BB_CODE_SIZE_AXIS)
            continue;
        plan->low[lane] = box->lo[lane];
        plan->scale[lane] = cells_per_unit(layout->count[lane], whole[lane]);
        if ((flips & 1u << lane) != 0)
            plan->flip |= places_of(layout, lane);
    }
    double unit = all > 0 && 1.0 / all <= FLT_MAX ? 1.0 / all : 0;
    plan->unit = (float)unit;
    if (unit > 0)
        plan_sizes(choice, layout, unit, whole);
}

void bb_code_letters(const bb_code_pattern *layout, char *text, size_t capacity)
{
    uint32_t i = 0;
    for (; i < layout->bits && i + 1 < capacity; i++) {
        uint64_t bit = UINT64_C(1) << (layout->bits - 1 - i);
        text[i] = ((layout->plan.flip & bit) != 0 ? "XYZS" : "xyzs")[layout->axes[i]];
    }
    text[i] = '\0';
}
