/* The figures of a simulated trace, one row each:
 *
 *   SIMT(id, member, name, unit, better, heading, help)
 *
 * `member` is that of bb_simulation, which simulate.c computes, and BB_F_SIMT_id the field of
 * results under `name` (framework/record/fields.h). `better`: LESS, MORE or NEITHER, for
 * comparisons, which take all of them as exact. Shares are NEITHER: a kernel that asks for less may
 * have fewer hits. A figure without a heading is in no table.
 *
 * This file has no guard: whoever includes it defines SIMT for its own purpose.
 */
/* clang-format off */
SIMT(RATE, mrays_s, "simt_mrays_s", "Mrays/s", MORE, "Simulated",
     "neither measured nor validated: the least of the bounds of a GPU on paper")
SIMT(ISSUE, issue_mrays_s, "simt_issue_mrays_s", "Mrays/s", MORE, NULL,
     "the bound by what is issued")
SIMT(L1, l1_mrays_s, "simt_l1_mrays_s", "Mrays/s", MORE, NULL, "the bound by the first caches")
SIMT(L2, l2_mrays_s, "simt_l2_mrays_s", "Mrays/s", MORE, NULL, "the bound by the second cache")
SIMT(MEMORY, memory_mrays_s, "simt_memory_mrays_s", "Mrays/s", MORE, NULL, "the bound by memory")
SIMT(EFFICIENCY, efficiency, "simt_efficiency", "", NEITHER, "SIMT efficiency",
     "active lanes per lane issued, over all instructions; simulated")
SIMT(NODES, node_efficiency, "simt_node_efficiency", "", NEITHER, NULL, "of steps at nodes")
SIMT(PRIMS, prim_efficiency, "simt_prim_efficiency", "", NEITHER, NULL, "of steps at primitives")
SIMT(SAMPLES, sample_efficiency, "simt_sample_efficiency", "", NEITHER, NULL,
     "of steps at samples of a volume")
SIMT(STEPS, steps, "simt_steps_per_ray", "per ray", LESS, NULL,
     "that the ray's group takes, whether the ray is active or not")
SIMT(LINES, lines, "simt_lines_per_step", "", NEITHER, NULL,
     "distinct lines of 128 bytes, of a step that reads nodes or primitives")
SIMT(STACK, stack_bytes, "simt_stack_bytes", "B", LESS, NULL, "of stack entries, per ray")
SIMT(L1_HITS, l1_hits, "simt_l1_hits", "", NEITHER, NULL, "share of sectors that a first cache had")
SIMT(L2_HITS, l2_hits, "simt_l2_hits", "", NEITHER, NULL,
     "share of the other sectors that the second cache had")
SIMT(BYTES, memory_bytes, "simt_memory_bytes", "B", LESS, NULL, "from and to memory, per ray")
SIMT(FLIGHT, in_flight, "simt_in_flight", "", NEITHER, NULL, "groups of a unit in flight")
SIMT(RAYS, rays, "simt_rays", "", NEITHER, NULL, "rays of the sample")
/* clang-format on */
#undef SIMT
