/* Host side of reinsert_moves.cl. */
#include "moves.h"

BB_DEVICE_SOURCE(reinsert_moves);

enum { GROUP_SIZE = 64 };

static bool by_levels(const bb_mover *mover)
{
    return mover->device->handover == BB_HANDOVER_LEVELS;
}

bb_status bb_mover_create(bb_device *device, bb_account *account, bb_mover *mover)
{
    char defines[96];
    mover->device = device;
    mover->account = account;
    bb_handover_defines(device, defines, sizeof defines);
    BB_TRY(bb_program_build(device, &bb_source_reinsert_moves, defines, &mover->program));
    BB_TRY(bb_kernel_get(mover->program, "moves_open", &mover->open));
    BB_TRY(bb_kernel_get(mover->program, "moves_clear", &mover->clear));
    BB_TRY(bb_kernel_get(mover->program, "moves_bid", &mover->bid));
    BB_TRY(bb_kernel_get(mover->program, "moves_tie", &mover->tie));
    BB_TRY(bb_kernel_get(mover->program, "moves_settle", &mover->settle));
    BB_TRY(bb_kernel_get(mover->program, "moves_make", &mover->make));
    BB_TRY(bb_kernel_get(mover->program, "moves_undo", &mover->undo));
    BB_TRY(bb_kernel_get(mover->program, "moves_arrive", &mover->arrive));
    if (!by_levels(mover))
        return bb_kernel_get(mover->program, "moves_refit", &mover->refit);
    BB_TRY(bb_kernel_get(mover->program, "moves_refit_first", &mover->refit_first));
    return bb_kernel_get(mover->program, "moves_refit_level", &mover->refit_level);
}

void bb_mover_release(bb_mover *mover)
{
    cl_kernel kernels[] = {mover->open,   mover->clear,       mover->bid,        mover->tie,
                           mover->settle, mover->make,        mover->undo,       mover->arrive,
                           mover->refit,  mover->refit_first, mover->refit_level};
    for (size_t i = 0; i < sizeof kernels / sizeof kernels[0]; i++)
        bb_kernel_release(kernels[i]);
    bb_program_release(mover->program);
    bb_buffer_release(&mover->states);
    bb_buffer_release(&mover->bids);
    bb_buffer_release(&mover->holders);
    bb_buffer_release(&mover->taken);
    bb_buffer_release(&mover->missing);
    bb_buffer_release(&mover->made);
    bb_levels_release(&mover->levels);
    *mover = (bb_mover){0};
}

static bb_status reserve_u32(bb_mover *mover, size_t count, const char *what, bb_buffer *out)
{
    return bb_buffer_reserve(mover->device, mover->account, count * sizeof(uint32_t), what, out);
}

bb_status bb_mover_reserve(bb_mover *mover, uint32_t count)
{
    const size_t families = count + 1ul;
    BB_TRY(reserve_u32(mover, 2 * families, "reinsert: states of moves", &mover->states));
    BB_TRY(reserve_u32(mover, families, "reinsert: bids", &mover->bids));
    BB_TRY(reserve_u32(mover, families, "reinsert: holders", &mover->holders));
    BB_TRY(reserve_u32(mover, families, "reinsert: taken", &mover->taken));
    BB_TRY(reserve_u32(mover, families, "reinsert: missing", &mover->missing));
    BB_TRY(reserve_u32(mover, 1, "reinsert: moves made", &mover->made));
    BB_TRY(bb_buffer_fill(&mover->missing, families * sizeof(uint32_t), 0));
    if (!by_levels(mover))
        return BB_OK;
    /* a tree has no more levels than families, and moves may make it that deep */
    return bb_levels_reserve(&mover->levels, mover->device, mover->account, count, count,
                             "reinsert: levels");
}

static uint32_t count_of(bb_moves moves)
{
    return moves.end - moves.begin;
}

/* Runs one round. *made: number of moves chosen so far, including earlier rounds. */
static bb_status choose_more(bb_mover *mover, bb_moves m, uint32_t *made)
{
    bb_device *device = mover->device;
    BB_TRY(bb_launch(device, mover->clear, count_of(m), GROUP_SIZE, BB_MEM(*m.buffer),
                     BB_VALUE(m.begin), BB_VALUE(m.end), BB_MEM(mover->states),
                     BB_MEM(mover->taken), BB_MEM(mover->bids), BB_MEM(mover->holders)));
    BB_TRY(bb_launch(device, mover->bid, count_of(m), GROUP_SIZE, BB_MEM(*m.buffer),
                     BB_VALUE(m.begin), BB_VALUE(m.end), BB_MEM(mover->states),
                     BB_MEM(mover->bids)));
    BB_TRY(bb_launch(device, mover->tie, count_of(m), GROUP_SIZE, BB_MEM(*m.buffer),
                     BB_VALUE(m.begin), BB_VALUE(m.end), BB_MEM(mover->states), BB_MEM(mover->bids),
                     BB_MEM(mover->holders)));
    BB_TRY(bb_launch(device, mover->settle, count_of(m), GROUP_SIZE, BB_MEM(*m.buffer),
                     BB_VALUE(m.begin), BB_VALUE(m.end), BB_MEM(mover->states),
                     BB_MEM(mover->holders), BB_MEM(mover->taken), BB_MEM(mover->made)));
    return bb_buffer_read(&mover->made, 0, sizeof *made, made);
}

bb_status bb_mover_choose(bb_mover *mover, bb_moves m, uint32_t *made)
{
    *made = 0;
    BB_TRY(bb_buffer_fill(&mover->made, sizeof(uint32_t), 0));
    BB_TRY(bb_launch(mover->device, mover->open, count_of(m), GROUP_SIZE, BB_MEM(*m.buffer),
                     BB_VALUE(m.begin), BB_VALUE(m.end), BB_MEM(mover->states),
                     BB_MEM(mover->taken)));
    for (uint32_t round = 0, before; round < BB_MOVE_ROUNDS; round++) {
        before = *made;
        BB_TRY(choose_more(mover, m, made));
        if (*made == before)
            break;
    }
    return BB_OK;
}

/* ---- boxes ---- */

typedef struct level_job {
    bb_mover *mover;
    bb_family_tree *tree;
} level_job;

static bb_status refit_level(void *context, const bb_levels *levels, uint32_t n)
{
    const level_job *job = context;
    return bb_launch(job->mover->device, job->mover->refit_level, bb_levels_items(levels),
                     GROUP_SIZE, BB_MEM(job->tree->families), BB_VALUE(job->tree->count),
                     BB_MEM(job->mover->missing), BB_MEM(levels->lists[n % 2]), BB_VALUE(n),
                     BB_MEM(levels->counts), BB_MEM(levels->lists[(n + 1) % 2]));
}

static bb_status refit(bb_mover *mover, bb_family_tree *tree, bb_moves m)
{
    BB_TRY(bb_launch(mover->device, mover->arrive, count_of(m), GROUP_SIZE, BB_MEM(*m.buffer),
                     BB_VALUE(m.begin), BB_VALUE(m.end), BB_MEM(mover->states),
                     BB_MEM(tree->families), BB_VALUE(tree->count), BB_MEM(mover->missing)));
    if (!by_levels(mover))
        return bb_launch(mover->device, mover->refit, count_of(m), GROUP_SIZE, BB_MEM(*m.buffer),
                         BB_VALUE(m.begin), BB_VALUE(m.end), BB_MEM(mover->states),
                         BB_MEM(tree->families), BB_VALUE(tree->count), BB_MEM(mover->missing));
    bb_levels *levels = &mover->levels;
    level_job job = {mover, tree};
    BB_TRY(bb_levels_start(levels));
    BB_TRY(bb_launch(mover->device, mover->refit_first, count_of(m), GROUP_SIZE, BB_MEM(*m.buffer),
                     BB_VALUE(m.begin), BB_VALUE(m.end), BB_MEM(mover->states),
                     BB_VALUE(tree->count), BB_MEM(mover->missing), BB_MEM(levels->counts),
                     BB_MEM(levels->lists[1])));
    return bb_levels_run(levels, refit_level, &job);
}

bb_status bb_mover_make(bb_mover *mover, bb_family_tree *tree, bb_moves m)
{
    BB_TRY(bb_launch(mover->device, mover->make, count_of(m), GROUP_SIZE, BB_MEM(*m.buffer),
                     BB_VALUE(m.begin), BB_VALUE(m.end), BB_MEM(mover->states),
                     BB_MEM(tree->families)));
    return refit(mover, tree, m);
}

bb_status bb_mover_undo(bb_mover *mover, bb_family_tree *tree, bb_moves m)
{
    BB_TRY(bb_launch(mover->device, mover->undo, count_of(m), GROUP_SIZE, BB_MEM(*m.buffer),
                     BB_VALUE(m.begin), BB_VALUE(m.end), BB_MEM(mover->states),
                     BB_MEM(tree->families)));
    return refit(mover, tree, m);
}
