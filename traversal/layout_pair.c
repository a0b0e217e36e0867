/* The `pair` layout: both children's boxes in the parent (kernels/layout_pair.cl). Binary trees keep their shape; wider ones
 * are made binary over the order of their children. */
#include "traversal/traversal.h"

#include "framework/clock.h"
#include "traversal/pairs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { GROUP_SIZE = 64 };

typedef struct pair_layout {
    bb_device *device;
    bb_account *account;
    bb_pairs pairs;
    cl_kernel records;
    bb_buffer none; /* stands for the arrays that a scene lacks */
} pair_layout;

static void destroy(void *opaque)
{
    pair_layout *self = opaque;
    if (self == NULL)
        return;
    bb_pairs_destroy(&self->pairs);
    bb_kernel_release(self->records);
    bb_buffer_release(&self->none);
    free(self);
}

static bb_status create(bb_device *device, bb_account *account, void **out)
{
    pair_layout *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    self->device = device;
    self->account = account;
    BB_TRY(bb_pairs_create(device, account, &self->pairs));
    BB_TRY(bb_kernel_get(self->pairs.program, "pair_records", &self->records));
    return bb_buffer_reserve(device, account, 16, "pair: empty array", &self->none);
}

static bb_status make_nodes(pair_layout *self, const bb_tree *tree, bb_layout_data *data)
{
    uint32_t count;
    BB_TRY(bb_pairs_make(&self->pairs, tree, &data->buffers[0], &count, &data->root));
    data->bytes += count * sizeof(bb_pair);
    return BB_OK;
}

static bb_status make_records(pair_layout *self, const bb_scene *scene, const bb_tree *tree,
                              bb_layout_data *data)
{
    const bb_scene_device *geometry = &scene->on_device;
    uint32_t words = BB_RECORD_WORDS, id_word = BB_RECORD_ID;
    if (scene->kinds == BB_SPHERES) {
        words = BB_SPHERE_RECORD_WORDS;
        id_word = BB_SPHERE_RECORD_ID;
    }
    uint32_t count = tree->info.ref_count;
    size_t bytes = (size_t)count * words * sizeof(uint32_t);
    BB_TRY(bb_buffer_reserve(self->device, self->account, bytes, "pair: primitive records",
                             &data->buffers[1]));
    data->bytes += bytes;
    bool triangles = scene->triangle_count > 0, spheres = scene->sphere_count > 0;
    return bb_launch(self->device, self->records, count, GROUP_SIZE, BB_MEM(tree->d_refs),
                     BB_VALUE(count), BB_MEM(*(triangles ? &geometry->vertices : &self->none)),
                     BB_MEM(*(triangles ? &geometry->indices : &self->none)),
                     BB_MEM(*(spheres ? &geometry->spheres : &self->none)),
                     BB_VALUE(scene->triangle_count), BB_VALUE(words), BB_VALUE(id_word),
                     BB_MEM(data->buffers[1]));
}

static bb_status make(void *opaque, const bb_scene *scene, bb_tree *tree, uint32_t leaf,
                      bb_layout_data *data)
{
    pair_layout *self = opaque;
    bb_tree collapsed;
    bb_tree_init(&collapsed, self->account);
    const bb_tree *source = tree;
    bb_status status = bb_finish(self->device);
    double start = bb_wall_ms();
    data->bytes = 0;
    data->buffer_count = 2;
    data->triangle_count = scene->triangle_count;
    data->sah = NAN;
    if (status == BB_OK && leaf > 1) {
        status = bb_tree_download(tree, NULL);
        if (status == BB_OK)
            status = bb_tree_collapse(tree, leaf, &collapsed);
        if (status == BB_OK)
            status = bb_tree_upload(&collapsed, self->device, NULL);
        source = &collapsed;
    }
    if (status == BB_OK)
        status = make_nodes(self, source, data);
    if (status == BB_OK)
        status = make_records(self, scene, source, data);
    if (status == BB_OK)
        status = bb_finish(self->device);
    data->ms = bb_wall_ms() - start;
    data->stack_need = bb_pairs_stack_need(&source->info);
    if (leaf > 1)
        snprintf(data->name, sizeof data->name, "pair:leaf=%u", leaf);
    else
        snprintf(data->name, sizeof data->name, "pair");
    data->keeps_shape = leaf == 1 && bb_pairs_keep_shape(&source->info);
    if (status == BB_OK && leaf > 1 && bb_pairs_keep_shape(&source->info))
        data->sah = bb_tree_sah(source); /* outside the clock */
    bb_tree_release(&collapsed);
    return status;
}

const bb_layout bb_layout_pair = {
    .name = "pair",
    .summary = "binary, both children's boxes in the parent; primitives expanded in leaf order",
    .create = create,
    .make = make,
    .destroy = destroy,
};
