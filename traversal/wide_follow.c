/* Updates boxes of wide nodes in place: host side of kernels/layout_wide_follow.cl. */
#include "traversal/wide_follow.h"

enum { GROUP_SIZE = 64, SIBLINGS_BYTES = 2 * sizeof(uint32_t) };

void bb_wide_follow_release(bb_wide_follow *self)
{
    bb_buffer_release(&self->sides);
    bb_buffer_release(&self->sources);
    bb_kernel_release(self->sources_kernel);
    bb_kernel_release(self->nodes_sources);
    bb_kernel_release(self->follow);
    bb_program_release(self->program);
    self->sources_kernel = self->nodes_sources = self->follow = NULL;
    self->program = NULL;
}

bb_status bb_wide_follow_reserve(bb_wide_follow *self, uint32_t node_count)
{
    self->known = false;
    return bb_buffer_reserve(self->device, self->account,
                             (size_t)node_count * self->width * sizeof(uint32_t),
                             "wide: what places are of", &self->sides);
}

static bb_status compile(bb_wide_follow *self, const char *defines)
{
    if (self->follow != NULL)
        return BB_OK;
    if (self->program == NULL)
        BB_TRY(bb_program_build(self->device, bb_source_find("layout_wide_follow.cl"), defines,
                                &self->program));
    if (self->sources_kernel == NULL)
        BB_TRY(bb_kernel_get(self->program, "wide_sources", &self->sources_kernel));
    if (self->nodes_sources == NULL)
        BB_TRY(bb_kernel_get(self->program, "wide_nodes_sources", &self->nodes_sources));
    return bb_kernel_get(self->program, "wide_follow", &self->follow);
}

/* Needs the sides of pairs only temporarily. */
static bb_status find_sources(bb_wide_follow *self, const bb_pairs *pairs,
                              const bb_layout_source *source, uint32_t node_count)
{
    uint32_t places = node_count * self->width;
    bb_buffer of_sides = {0};
    BB_TRY(bb_buffer_reserve(self->device, self->account, (size_t)places * SIBLINGS_BYTES,
                             "wide: what places are of", &self->sources));
    if (pairs == NULL) {
        BB_TRY(bb_launch(self->device, self->nodes_sources, places, GROUP_SIZE, BB_MEM(self->sides),
                         BB_VALUE(places), BB_MEM(self->sources)));
        self->known = true;
        return BB_OK;
    }
    bb_status status = bb_pairs_sides(pairs, source->tree, &of_sides);
    if (status == BB_OK)
        status =
            bb_launch(self->device, self->sources_kernel, places, GROUP_SIZE, BB_MEM(self->sides),
                      BB_VALUE(places), BB_MEM(of_sides), BB_MEM(self->sources));
    bb_buffer_release(&of_sides);
    self->known = status == BB_OK;
    return status;
}

bb_status bb_wide_follow_boxes(bb_wide_follow *self, const bb_pairs *pairs, const char *defines,
                               const bb_layout_source *source, uint32_t node_count,
                               const bb_buffer *nodes)
{
    const bb_buffer *reach = source->reach != NULL ? source->reach : &self->sources;
    uint32_t has_reach = source->reach != NULL;
    float scale = source->scene->scale;
    BB_TRY(compile(self, defines));
    if (!self->known)
        BB_TRY(find_sources(self, pairs, source, node_count));
    return bb_launch(self->device, self->follow, node_count, GROUP_SIZE,
                     BB_MEM(source->tree->d_nodes), BB_MEM(self->sources), BB_VALUE(node_count),
                     BB_VALUE(scale), BB_MEM(*reach), BB_VALUE(has_reach), BB_MEM(*nodes));
}
