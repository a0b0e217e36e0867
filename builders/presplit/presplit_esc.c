/* Early split clipping on the host.
 *
 *   make a reference to each primitive, with its box
 *   while there is room, and the largest box is larger than `above` times the average one:
 *       halve it along its longest side, and shrink each half to the primitive's part in it, if
 *       this saves the share `saves` of the area
 *
 * Ernst, Greiner 2007 (Early Split Clipping for Bounding Volume Hierarchies). Where this knowingly
 * departs from it: a heap replaces recursion down to a threshold, so that the largest boxes are
 * split first and the budget holds for any threshold. Size is the surface area. Triangles are
 * clipped, spheres stay whole, and boxes of other kinds are halved without clipping.
 *
 * `saves` is our addition: half of a wall's box is as full as the whole, so halving it makes the
 * tree larger and no better, while the boxes of a long triangle at an angle shrink to half.
 *
 * Limits: one thread. Ties go to the reference with the lowest number, so the result depends only
 * on the scene.
 */
#include "presplit_esc.h"
#include "clip.h"

#include <string.h>

/* A reference that may be halved. */
typedef struct candidate {
    double area;
    uint32_t index;
} candidate;

struct ps_esc {
    bb_account *account;
    ps_esc_limits limits;
    candidate *heap; /* largest first */
    uint32_t heap_count;
    size_t heap_capacity;
};

void ps_esc_destroy(ps_esc *self)
{
    if (self == NULL)
        return;
    bb_host_free(self->heap);
    bb_host_free(self);
}

bb_status ps_esc_create(bb_account *account, ps_esc_limits limits, ps_esc **out)
{
    ps_esc *self = NULL;
    BB_TRY(bb_host_alloc(account, sizeof *self, "presplit: early splits", &self));
    memset(self, 0, sizeof *self);
    *out = self;
    self->account = account;
    self->limits = limits;
    return BB_OK;
}

static size_t most_references(const ps_esc *self, const bb_scene *scene)
{
    return (size_t)(self->limits.budget * scene->prim_count);
}

bb_status ps_esc_prepare(ps_esc *self, const bb_scene *scene)
{
    size_t most = most_references(self, scene);
    if (most <= self->heap_capacity)
        return BB_OK;
    self->heap_capacity = 0;
    BB_TRY(bb_host_alloc(self->account, most * sizeof *self->heap, "presplit: heap", &self->heap));
    self->heap_capacity = most;
    return BB_OK;
}

/* ---- the heap ---- */

static bool comes_first(const candidate *a, const candidate *b)
{
    return a->area > b->area || (a->area == b->area && a->index < b->index);
}

static void push(ps_esc *self, candidate item)
{
    candidate *heap = self->heap;
    uint32_t at = self->heap_count++;
    for (; at > 0 && comes_first(&item, &heap[(at - 1) / 2]); at = (at - 1) / 2)
        heap[at] = heap[(at - 1) / 2];
    heap[at] = item;
}

static candidate pop(ps_esc *self)
{
    candidate *heap = self->heap, top = heap[0], last = heap[--self->heap_count];
    uint32_t at = 0, count = self->heap_count;
    for (uint32_t child = 1; child < count; child = 2 * at + 1) {
        child += child + 1 < count && comes_first(&heap[child + 1], &heap[child]);
        if (!comes_first(&heap[child], &last))
            break;
        heap[at] = heap[child];
        at = child;
    }
    heap[at] = last;
    return top;
}

/* ---- splitting ---- */

static double area_of(const bb_box *box)
{
    return bb_half_area(box->lo, box->hi);
}

static int longest_axis(const bb_box *box)
{
    int longest = 0;
    for (int k = 1; k < 3; k++)
        if ((double)box->hi[k] - box->lo[k] > (double)box->hi[longest] - box->lo[longest])
            longest = k;
    return longest;
}

/* Halves reference `index` into itself and a new one at the end. Returns false if that does not
 * save enough, or if no float lies between the ends. */
static bool halve(const ps_esc *self, const bb_scene *scene, bb_references *references,
                  uint32_t index)
{
    bb_box *box = &references->boxes[index], halves[2] = {*box, *box};
    const bb_prims *spheres = &scene->prims[BB_SPHERE];
    if (references->prims[index] - spheres->first < spheres->count)
        return false; /* the sphere test is proven only for boxes of whole spheres */
    int axis = longest_axis(box);
    float middle = 0.5f * box->lo[axis] + 0.5f * box->hi[axis];
    if (!(box->lo[axis] < middle && middle < box->hi[axis]))
        return false;
    halves[0].hi[axis] = halves[1].lo[axis] = middle;
    bb_clip_primitive(scene, references->prims[index], &halves[0]);
    bb_clip_primitive(scene, references->prims[index], &halves[1]);
    if (area_of(&halves[0]) + area_of(&halves[1]) > (1 - self->limits.saves) * area_of(box))
        return false;
    *box = halves[0];
    references->boxes[references->count] = halves[1];
    references->prims[references->count++] = references->prims[index];
    return true;
}

bb_status ps_esc_split(ps_esc *self, const bb_scene *scene, bb_references *references,
                       bb_phases *phases)
{
    size_t most = most_references(self, scene);
    double sum = 0;
    bb_phases_on_host(phases);
    BB_TRY(ps_esc_prepare(self, scene));
    BB_TRY(bb_references_reserve(references, NULL, BB_ON_HOST, most));
    BB_TRY(bb_phase(phases, "areas"));
    references->count = scene->prim_count;
    memcpy(references->boxes, scene->boxes, scene->prim_count * sizeof *scene->boxes);
    for (uint32_t i = 0; i < scene->prim_count; i++) {
        references->prims[i] = i;
        sum += area_of(&scene->boxes[i]);
    }
    BB_TRY(bb_phase(phases, "split"));
    double least = self->limits.above * sum / scene->prim_count;
    self->heap_count = 0;
    for (uint32_t i = 0; i < scene->prim_count; i++)
        if (area_of(&scene->boxes[i]) > least)
            push(self, (candidate){area_of(&scene->boxes[i]), i});
    while (self->heap_count > 0 && references->count < most) {
        uint32_t index = pop(self).index;
        const uint32_t halves[2] = {index, references->count};
        if (!halve(self, scene, references, index))
            continue;
        for (int i = 0; i < 2; i++) {
            candidate half = {area_of(&references->boxes[halves[i]]), halves[i]};
            if (half.area > least)
                push(self, half);
        }
    }
    return bb_phase(phases, NULL);
}
