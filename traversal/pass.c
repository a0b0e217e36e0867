#include "traversal/pass.h"

bb_status bb_pass_poison(const bb_pass *pass, uint32_t count)
{
    BB_TRY(bb_buffer_fill(pass->hits, count * sizeof(bb_hit), BB_POISON));
    return bb_finish(pass->hits->device);
}

bb_status bb_pass_launch(const bb_pass *pass, uint32_t count)
{
    return bb_tracer_launch(pass->tracer, pass->layout, pass->rays, count, pass->hits,
                            pass->counts);
}

bb_status bb_pass_run(const bb_pass *pass, uint32_t count, bb_hit *hits, bb_count *counts)
{
    BB_TRY(bb_pass_poison(pass, count));
    BB_TRY(bb_pass_launch(pass, count));
    BB_TRY(bb_buffer_read(pass->hits, 0, count * sizeof *hits, hits));
    return counts == NULL ? BB_OK : bb_buffer_read(pass->counts, 0, count * sizeof *counts, counts);
}
