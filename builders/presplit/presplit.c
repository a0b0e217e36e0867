/* presplit: early split clipping, on the host; a splitter, which makes references of primitives.
 *
 *   a reference to each primitive, with its box
 *   while there is room, and the largest box is larger than `above` of the average ones:
 *       halve it along its longest side, and shrink each half to the primitive's part in it,
 *       if the halves are smaller together by the share that `saves` asks for
 *
 * Ernst, Greiner 2007 (Early Split Clipping for Bounding Volume Hierarchies), whose recursion by a
 * threshold is a heap here, so that the room goes to the largest boxes first, and a budget holds
 * whatever the threshold. Size is the surface area, as theirs. Triangles are clipped, spheres stay
 * whole, and of any other kind the halves of the box hold all there is.
 *
 * `saves` is of our own: half of a wall's box is as full as the whole, so halving it makes the tree
 * larger and no better, while the boxes of a long triangle that lies askew shrink to half.
 *
 * Limits: one thread. A tie goes to the reference of the least number, so the result depends on the
 * scene alone.
 */
#include "clip.h"
#include "framework/builder/builder.h"

#include <stdio.h>
#include <string.h>

static const bb_option options[] = {
    {"budget", "1.5", NULL, "most references per primitive of the scene, 1 to 16"},
    {"above", "0.5", NULL,
     "smallest box to split: its area, relative to the mean of all boxes, 0 to 1e9"},
    {"saves", "0.3", NULL,
     "least area that a split must save, as a share of the box's, -1 to 0.9; -1: any"},
    {.name = NULL},
};

/* A reference that may be halved. */
typedef struct candidate {
    double area;
    uint32_t index;
} candidate;

typedef struct presplit {
    bb_account *account;
    double budget, above, saves;
    candidate *heap; /* the largest first */
    uint32_t heap_count;
    size_t heap_capacity;
    uint32_t prims, references; /* of the last build */
} presplit;

static void destroy(void *opaque)
{
    presplit *self = opaque;
    if (self == NULL)
        return;
    bb_host_free(self->heap);
    bb_host_free(self);
}

static bb_status create(const bb_builder_context *context, void **out)
{
    presplit *self = NULL;
    BB_TRY(bb_host_alloc(context->account, sizeof *self, "presplit: object", &self));
    memset(self, 0, sizeof *self);
    *out = self;
    self->account = context->account;
    BB_TRY(bb_spec_double(context->spec, options, "budget", 1, 16, &self->budget));
    BB_TRY(bb_spec_double(context->spec, options, "above", 0, 1e9, &self->above));
    return bb_spec_double(context->spec, options, "saves", -1, 0.9, &self->saves);
}

static size_t most_references(const presplit *self, const bb_scene *scene)
{
    return (size_t)(self->budget * scene->prim_count);
}

static bb_status prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    (void)tree;
    presplit *self = opaque;
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

static void push(presplit *self, candidate item)
{
    candidate *heap = self->heap;
    uint32_t at = self->heap_count++;
    for (; at > 0 && comes_first(&item, &heap[(at - 1) / 2]); at = (at - 1) / 2)
        heap[at] = heap[(at - 1) / 2];
    heap[at] = item;
}

static candidate pop(presplit *self)
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

/* Halves reference `index` into itself and a new one at the end; false if that does not save
 * enough, or no float lies between. */
static bool halve(const presplit *self, const bb_scene *scene, bb_references *references,
                  uint32_t index)
{
    bb_box *box = &references->boxes[index], halves[2] = {*box, *box};
    const bb_prims *spheres = &scene->prims[BB_SPHERE];
    if (references->prims[index] - spheres->first < spheres->count)
        return false; /* the kernels' test of a sphere is proven for boxes that hold it whole */
    int axis = longest_axis(box);
    float middle = 0.5f * box->lo[axis] + 0.5f * box->hi[axis];
    if (!(box->lo[axis] < middle && middle < box->hi[axis]))
        return false;
    halves[0].hi[axis] = halves[1].lo[axis] = middle;
    bb_clip_primitive(scene, references->prims[index], &halves[0]);
    bb_clip_primitive(scene, references->prims[index], &halves[1]);
    if (area_of(&halves[0]) + area_of(&halves[1]) > (1 - self->saves) * area_of(box))
        return false;
    *box = halves[0];
    references->boxes[references->count] = halves[1];
    references->prims[references->count++] = references->prims[index];
    return true;
}

static bb_status split(void *opaque, const bb_scene *scene, bb_references *references,
                       bb_phases *phases)
{
    presplit *self = opaque;
    size_t most = most_references(self, scene);
    double sum = 0;
    BB_TRY(prepare(self, scene, NULL));
    BB_TRY(bb_references_reserve(references, NULL, BB_ON_HOST, most));
    BB_TRY(bb_phase(phases, "areas"));
    references->count = scene->prim_count;
    memcpy(references->boxes, scene->boxes, scene->prim_count * sizeof *scene->boxes);
    for (uint32_t i = 0; i < scene->prim_count; i++) {
        references->prims[i] = i;
        sum += area_of(&scene->boxes[i]);
    }
    BB_TRY(bb_phase(phases, "split"));
    double least = self->above * sum / scene->prim_count;
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
    self->prims = scene->prim_count;
    self->references = references->count;
    return bb_phase(phases, NULL);
}

static bb_status describe(void *opaque, const bb_scene *scene, char *text, size_t capacity)
{
    (void)scene;
    const presplit *self = opaque;
    snprintf(text, capacity, "%u references to %u primitives", self->references, self->prims);
    return BB_OK;
}

const bb_builder bb_builder_presplit = {
    .abi_version = BB_ABI_VERSION,
    .name = "presplit",
    .summary = "splitter: halves large boxes and clips the parts to their primitives, on the host",
    .paper = "Ernst, Greiner 2007",
    .kinds = BB_ALL_KINDS,
    .inputs = BB_INPUT_BOXES | BB_INPUT_GEOMETRY,
    .place = BB_ON_HOST,
    .deterministic = true,
    .options = options,
    .compared = "",
    .create = create,
    .prepare = prepare,
    .split = split,
    .describe = describe,
    .destroy = destroy,
};
