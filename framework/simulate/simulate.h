/* Simulates the trace of a ray set on a GPU on paper: the steps of a sample of groups are recorded,
 * replayed in lockstep, and run through its caches. Bounds follow from what was counted. Nothing
 * here is timed: the same figures come out on any machine.
 *
 * Left out: how long loads take beyond what the groups in flight hide, how a scheduler chooses
 * among them, hardware for ray tracing, and instructions that two groups could issue together.
 */
#ifndef BB_SIMULATE_H
#define BB_SIMULATE_H

#include "framework/simulate/description.h"
#include "framework/simulate/machine.h"

#define BB_SIMT "simt"

enum { BB_SIMT_MAX = 4 }; /* simulations at once */

/* 32,768 groups of 32, or 16,384 of 64; at least a sixteenth of that. */
#define BB_SIMT_SAMPLE ((bb_sample_size){.least = 1 << 16, .most = 1 << 20})

/* What `--metrics simt:device=h100,width=32` asks for. */
typedef struct bb_simt {
    char name[80]; /* as recorded, with its options in one order: "simt:device=h100,width=32" */
    bb_description device;
    uint32_t width; /* rays of a group */
} bb_simt;

extern const bb_option bb_simt_options[];
/* Returns whether `text` asks for a simulation, well or not. */
bool bb_is_simt(const char *text);
/* Takes those metrics that ask for simulations. BB_INVALID for an unknown option, value or device,
 * for more than BB_SIMT_MAX, or two that are the same. */
bb_status bb_simts_parse(char *const *metrics, uint32_t metric_count, bb_simt simts[BB_SIMT_MAX],
                         uint32_t *count);
/* What bounds the speed. */
typedef enum bb_binding {
    BB_BY_ISSUE,
    BB_BY_FIRST,
    BB_BY_SECOND,
    BB_BY_MEMORY,
    BB_BINDINGS
} bb_binding;

/* NAN: there is no such figure; an infinite bound does not bind. Without a bound by issue there is
 * no least bound, and `binds` means nothing. */
typedef struct bb_simulation {
    bb_traffic traffic;
    bb_binding binds; /* the least bound */
#define SIMT(id, member, name, unit, better, heading, help) double member;
#include "framework/simulate/simt_figures.h"
} bb_simulation;

/* The word for it: "issue", "L1", "L2", "memory". */
const char *bb_binding_word(bb_binding binding);
/* Returns what the word says; BB_BINDINGS for any other. */
bb_binding bb_binding_of(const char *word);

/* Returns whether the instructions and registers of a ray are known, for a layout of these kinds of
 * primitives, so that there is a bound by issue: those of the closest hit stand for any hit, too.
 * If not, so many groups are in flight as a unit holds. */
bool bb_simulates_bounds(const bb_kernel *kernel, uint32_t kinds);

/* A kernel, and what its steps read. */
typedef struct bb_simulated_code {
    char program[512];  /* of its row in kernels/isa.tsv, perhaps with options */
    const char *kernel; /* NULL: none of the rows is of its code */
    bb_footing footing;
    uint32_t *listed; /* what footing.lists.tets is; NULL: nothing */
} bb_simulated_code;

void bb_simulated_code_release(bb_simulated_code *code); /* a zeroed one is allowed */

/* Simulates recorded steps of any kernel. Where the instructions of its steps are not known, what
 * depends on them is left out: `mrays_s`, `issue_mrays_s`, `efficiency`. BB_UNSUPPORTED if
 * kernels/isa.tsv has no row of the code, and for work-groups that would tear runs of a sample
 * apart or are larger than those of GPUs. */
bb_status bb_simulate_code(const bb_simt *simt, const bb_simulated_code *code,
                           const bb_steps *steps, bb_simulation *simulation);

/* Simulates recorded steps of the request's kernel in this layout. BB_UNSUPPORTED if nothing is
 * known of the kernel's code. */
bb_status bb_simulate(const bb_simt *simt, const bb_traverser_request *request,
                      const bb_layout_data *layout, const bb_steps *steps,
                      bb_simulation *simulation);

#endif
