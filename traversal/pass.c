#include "traversal/pass.h"

static size_t bytes_of(const bb_pass *pass, uint32_t count)
{
    return count * pass->query->result_bytes;
}

bb_status bb_pass_poison(const bb_pass *pass, uint32_t count)
{
    BB_TRY(bb_buffer_fill(pass->results, bytes_of(pass, count), BB_POISON));
    return bb_finish(pass->results->device);
}

bb_status bb_pass_launch(const bb_pass *pass, uint32_t count)
{
    BB_TRY(bb_pass_sort(pass, count));
    return bb_pass_trace(pass, count);
}

bb_status bb_pass_sort(const bb_pass *pass, uint32_t count)
{
    return bb_traverser_sorts(pass->traverser)
               ? bb_traverser_sort(pass->traverser, pass->layout, pass->rays, count)
               : BB_OK;
}

bb_status bb_pass_trace(const bb_pass *pass, uint32_t count)
{
    return bb_traverser_launch(pass->traverser, pass->layout, pass->rays, count, pass->results,
                               pass->counts, pass->recording, pass->more, pass->more_count);
}

bb_status bb_pass_run(const bb_pass *pass, uint32_t count, void *results, bb_count *counts)
{
    BB_TRY(bb_pass_poison(pass, count));
    BB_TRY(bb_pass_launch(pass, count));
    BB_TRY(bb_buffer_read(pass->results, 0, bytes_of(pass, count), results));
    return counts == NULL ? BB_OK : bb_buffer_read(pass->counts, 0, count * sizeof *counts, counts);
}
