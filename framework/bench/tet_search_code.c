/* What the steps of a search of tetrahedra read, for its simulation. */
#include "framework/base/memory.h"
#include "framework/bench/tet_search.h"

#include <stdio.h>

enum { ALIGNMENT = 256 };

static uint64_t aligned(uint64_t bytes)
{
    return (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

/* Copies the list of primitives; counts from the first tetrahedron. */
static bb_status copy_list(const bb_tet_search *search, uint32_t refs, uint32_t **tets)
{
    const size_t bytes = refs * sizeof **tets;
    BB_TRY(bb_host_alloc(NULL, bytes, "a list of tetrahedra", tets));
    BB_TRY(bb_buffer_read(&search->data->buffers[BB_OLBVH_P], 0, bytes, *tets));
    for (uint32_t i = 0; i < refs; i++)
        (*tets)[i] = (*tets)[i] < search->args.first ? BB_NONE : (*tets)[i] - search->args.first;
    return BB_OK;
}

/* Arrays follow each other: of nodes the words that say what they have, boxes, flags; of primitives
 * the list, corners, vertices. */
static bb_status find_lists(const bb_tet_search *search, bb_simulated_code *code)
{
    const bb_scene *scene = search->scene;
    const bb_buffer *buffers = search->data->buffers;
    bb_footing *f = &code->footing;
    uint32_t nodes, refs;
    BB_TRY(bb_buffer_read(&buffers[BB_OLBVH_NO], search->data->levels * sizeof nodes, sizeof nodes,
                          &nodes));
    BB_TRY(bb_buffer_read(&buffers[BB_OLBVH_PO], nodes * sizeof refs, sizeof refs, &refs));
    if (nodes > BB_STEP_INDEX_MASK >> 1 || refs > BB_STEP_INDEX_MASK)
        return bb_fail(BB_UNSUPPORTED, "the tree has more nodes or references than steps can name");
    BB_TRY(copy_list(search, refs, &code->listed));
    const uint64_t vertices = scene->vertex_count * 3ull * sizeof(float);
    bb_footing_lists *l = &f->lists;
    l->tets = code->listed;
    l->corners = bb_scene_tet(scene, 0);
    l->boxes_at = aligned((nodes + 1ull) * sizeof(uint32_t));
    l->flags_at = l->boxes_at + aligned(nodes * 6ull * sizeof(float));
    l->corners_at = aligned(refs * sizeof(uint32_t));
    l->vertices_at =
        l->corners_at + aligned(scene->prims[BB_TETRAHEDRON].count * 4ull * sizeof(uint32_t));
    f->nodes_bytes = l->flags_at + nodes;
    f->prims_bytes = l->vertices_at + vertices;
    f->control = BB_UNTIL_LEAF;
    f->ring = BB_OLBVH_STACK;
    f->is_link = true;
    return BB_OK;
}

bb_status bb_tet_search_code(const bb_tet_search *search, const char *kernel, bool by_boundary,
                             bb_simulated_code *code)
{
    const bb_layout *layout = search->layout;
    const bool has_variant = bb_tet_search_has_boundary(search->way) && !by_boundary;
    snprintf(code->program, sizeof code->program, "%s/%s%s", kernel,
             layout != NULL ? layout->name : "all", has_variant ? ":boundary=no" : "");
    code->kernel = kernel;
    bb_footing *f = &code->footing;
    *f = (bb_footing){.control = BB_IF_ELSE,
                      .group = BB_TET_GROUP,
                      .node_bytes = layout != NULL ? layout->node_bytes : 0,
                      .prim_bytes = search->args.words * (uint32_t)sizeof(bb_u32)};
    if (search->way == BB_SEARCH_OLBVH)
        return find_lists(search, code);
    if (layout == NULL) {
        f->prims_bytes = (uint64_t)search->scene->prims[BB_TETRAHEDRON].count * f->prim_bytes;
    } else {
        f->nodes_bytes = search->data->bytes - search->data->prims_bytes;
        f->prims_bytes = search->data->prims_bytes;
    }
    return BB_OK;
}
