/* Spatial splits: bins references (Stich, Friedrich, Dietrich 2009; see sbvh.c).
 *
 *   K slabs of equal width cut the node's box; each reference is cut by the slabs it reaches:
 *       box[k] grows by its part there; enter[first slab]++, leave[last slab]++
 *   cost of plane k = A(boxes below) sum of enter below + A(boxes above) sum of leave above
 *
 *   a reference across the chosen plane is cut in two, or goes to one side whole ("unsplit"),
 *   whichever costs least given the sides so far
 *
 * An axis on which two planes coincide, since slabs are thinner than floats resolve, is skipped.
 */
#include "sbvh_split.h"

#include <math.h>
#include <string.h>

typedef struct slab {
    sb_bounds box;
    uint32_t enter, leave;
} slab;

/* Planes 0 .. bins of one axis. */
typedef struct ruler {
    float planes[SB_BINS_MAX + 1];
    uint32_t bins;
    double scale;
} ruler;

static bool make_ruler(ruler *r, float low, float high, uint32_t bins)
{
    double extent = (double)high - low;
    r->bins = bins;
    r->scale = extent > 0 ? bins / extent : 0;
    if (!isfinite(r->scale) || r->scale == 0)
        return false;
    for (uint32_t k = 0; k <= bins; k++)
        r->planes[k] = k == bins ? high : (float)(low + extent * k / bins) + 0.0f;
    for (uint32_t k = 0; k < bins; k++)
        if (!(r->planes[k] < r->planes[k + 1]))
            return false;
    return true;
}

/* Returns k with planes[k] <= x < planes[k + 1], clamped to the slabs. */
static uint32_t slab_from(const ruler *r, float x)
{
    double place = ((double)x - r->planes[0]) * r->scale;
    uint32_t k = place <= 0 ? 0 : place < r->bins ? (uint32_t)place : r->bins - 1;
    while (k > 0 && x < r->planes[k])
        k--;
    while (k + 1 < r->bins && x >= r->planes[k + 1])
        k++;
    return k;
}

/* Returns k with planes[k] < x <= planes[k + 1], clamped to the slabs. */
static uint32_t slab_to(const ruler *r, float x)
{
    uint32_t k = slab_from(r, x);
    return k > 0 && x <= r->planes[k] ? k - 1 : k;
}

static void bin_one(const bb_scene *scene, const sb_ref *ref, int axis, const ruler *r, slab *slabs)
{
    uint32_t first, last;
    if (sb_can_cut(scene, ref)) {
        first = slab_from(r, ref->box.lo[axis]);
        last = slab_to(r, ref->box.hi[axis]);
    } else {
        first = last = slab_from(r, sb_centroid(ref, axis));
    }
    sb_ref rest = *ref;
    uint32_t entered = BB_NONE, left = first;
    for (uint32_t k = first; k < last && rest.box.lo[0] <= rest.box.hi[0]; k++) {
        const float plane = r->planes[k + 1];
        sb_bounds sides[2];
        if (rest.box.lo[axis] >= plane) /* the previous cut left nothing in this slab */
            continue;
        if (rest.box.hi[axis] <= plane) {
            last = k;
            break;
        }
        sb_cut(scene, &rest, axis, plane, sides);
        rest.box = sides[1];
        if (sides[0].lo[0] > sides[0].hi[0])
            continue;
        sb_grow(&slabs[k].box, &sides[0]);
        entered = entered == BB_NONE ? k : entered;
        left = k;
    }
    if (rest.box.lo[0] <= rest.box.hi[0]) {
        last = first <= last ? last : first;
        sb_grow(&slabs[last].box, &rest.box);
        entered = entered == BB_NONE ? last : entered;
        left = last;
    }
    if (entered == BB_NONE) { /* the primitive is not in its box, which is slightly too large */
        sb_grow(&slabs[first].box, &ref->box);
        entered = left = first;
    }
    slabs[entered].enter++;
    slabs[left].leave++;
}

static void try_axis(const slab *slabs, const ruler *r, int axis, uint32_t count, uint32_t spare,
                     sb_split *best)
{
    sb_bounds above[SB_BINS_MAX + 1], below = sb_nothing();
    uint32_t right = count, left = 0;
    above[r->bins] = sb_nothing();
    for (uint32_t k = r->bins; k-- > 1;) {
        above[k] = above[k + 1];
        sb_grow(&above[k], &slabs[k].box);
    }
    for (uint32_t k = 1; k < r->bins; k++) {
        sb_grow(&below, &slabs[k - 1].box);
        left += slabs[k - 1].enter;
        right -= slabs[k - 1].leave;
        double cost = sb_area(&below) * left + sb_area(&above[k]) * right;
        if (left == 0 || right == 0 || left + right - count > spare ||
            (best->left > 0 && cost >= best->cost))
            continue;
        *best = (sb_split){.cost = cost,
                           .left = left,
                           .right = right,
                           .sides = {below, above[k]},
                           .axis = axis,
                           .plane = r->planes[k]};
    }
}

sb_split sb_find_spatial(const bb_scene *scene, const sb_ref *refs, uint32_t count,
                         const sb_bounds *box, uint32_t bins, uint32_t spare)
{
    sb_split best = {.left = 0};
    for (int axis = 0; axis < 3; axis++) {
        slab slabs[SB_BINS_MAX];
        ruler r;
        if (!make_ruler(&r, box->lo[axis], box->hi[axis], bins))
            continue;
        for (uint32_t k = 0; k < bins; k++)
            slabs[k] = (slab){sb_nothing(), 0, 0};
        for (uint32_t i = 0; i < count; i++)
            bin_one(scene, &refs[i], axis, &r, slabs);
        try_axis(slabs, &r, axis, count, spare, &best);
    }
    return best;
}

/* ---- the partition ---- */

enum { LEFT, RIGHT, ACROSS };

static int side_of(const bb_scene *scene, const sb_ref *ref, const sb_split *split)
{
    const float lo = ref->box.lo[split->axis], hi = ref->box.hi[split->axis];
    if (!sb_can_cut(scene, ref))
        return sb_centroid(ref, split->axis) >= split->plane ? RIGHT : LEFT;
    return lo >= split->plane ? RIGHT : hi <= split->plane ? LEFT : ACROSS;
}

/* Both sides, as far as they are filled. */
typedef struct growing {
    sb_bounds box[2];
    uint32_t count[2];
} growing;

static double area_with(const sb_bounds *box, const sb_bounds *more)
{
    sb_bounds both = *box;
    sb_grow(&both, more);
    return sb_area(&both);
}

static void put(growing *g, int side, const sb_bounds *box)
{
    sb_grow(&g->box[side], box);
    g->count[side]++;
}

/* Returns the side of a reference across the plane, or ACROSS if it is best cut: `parts` then go to
 * both sides. */
static int choose(growing *g, const sb_bounds *whole, const sb_bounds parts[2], bool may_cut)
{
    if (parts[0].lo[0] > parts[0].hi[0])
        return RIGHT;
    if (parts[1].lo[0] > parts[1].hi[0])
        return LEFT;
    const double left = g->count[LEFT], right = g->count[RIGHT];
    const double area[2] = {sb_area(&g->box[LEFT]), sb_area(&g->box[RIGHT])};
    double both = area_with(&g->box[LEFT], &parts[0]) * (left + 1) +
                  area_with(&g->box[RIGHT], &parts[1]) * (right + 1);
    double all_left = area_with(&g->box[LEFT], whole) * (left + 1) + area[RIGHT] * right;
    double all_right = area[LEFT] * left + area_with(&g->box[RIGHT], whole) * (right + 1);
    if (may_cut && both < all_left && both < all_right)
        return ACROSS;
    return all_left <= all_right ? LEFT : RIGHT;
}

/* The slabs cut a reference at several planes, this function at one. Floats may round differently,
 * and so the numbers of references may differ, hence `spare`. */
void sb_part_spatial(const bb_scene *scene, sb_ref *refs, uint32_t count, uint32_t spare,
                     sb_split *split, sb_ref *scratch)
{
    growing g = {{sb_nothing(), sb_nothing()}, {0, 0}};
    uint32_t left = 0, right = 0;
    for (uint32_t i = 0; i < count; i++) {
        int side = side_of(scene, &refs[i], split);
        if (side != ACROSS)
            put(&g, side, &refs[i].box);
    }
    for (uint32_t i = 0; i < count; i++) {
        sb_ref ref = refs[i];
        int side = side_of(scene, &ref, split);
        if (side == ACROSS) {
            sb_bounds parts[2];
            sb_cut(scene, &ref, split->axis, split->plane, parts);
            side = choose(&g, &ref.box, parts, left + right - i < spare);
            if (side == ACROSS) {
                put(&g, LEFT, &parts[0]);
                put(&g, RIGHT, &parts[1]);
                scratch[left++] = (sb_ref){parts[0], ref.prim};
                refs[right++] = (sb_ref){parts[1], ref.prim};
                continue;
            }
            put(&g, side, &ref.box);
        }
        if (side == LEFT)
            scratch[left++] = ref;
        else
            refs[right++] = ref;
    }
    memcpy(refs + right, scratch, left * sizeof *refs);
    split->left = left;
    split->right = right;
}
