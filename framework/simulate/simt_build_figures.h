/* The figures of a simulated build, one row each, as simt_figures.h has those of a trace:
 *
 *   SIMT_BUILD(id, member, name, unit, better, heading, help)
 *
 * `member` is that of bb_build_simulation, which build.c computes; BB_F_SIMT_BUILD_id is the field.
 *
 * This file has no guard: whoever includes it defines SIMT_BUILD for its own purpose.
 */
/* clang-format off */
SIMT_BUILD(MS, ms, "simt_build_ms", "ms", LESS, "Simulated ms",
           "neither measured nor validated: what a GPU on paper takes at least, by bytes")
SIMT_BUILD(L2, l2_ms, "simt_build_l2_ms", "ms", LESS, NULL, "the bound by the second cache")
SIMT_BUILD(MEMORY, memory_ms, "simt_build_memory_ms", "ms", LESS, NULL, "the bound by memory")
SIMT_BUILD(BYTES, bytes, "simt_build_bytes", "B", LESS, NULL, "that a build moves; simulated")
SIMT_BUILD(MEMORY_BYTES, memory_bytes, "simt_build_memory_bytes", "B", LESS, NULL,
           "of these, from and to memory")
SIMT_BUILD(LAUNCHES, launches, "simt_build_launches", "", LESS, "GPU launches",
           "kernels, fills and copies of a build in its form for GPUs; simulated")
SIMT_BUILD(WAITS, waits, "simt_build_waits", "", LESS, NULL, "of the host for the device")
SIMT_BUILD(SORT_PASSES, sort_passes, "simt_build_sort_passes", "", LESS, NULL,
           "over all pairs of a sort")
/* clang-format on */
#undef SIMT_BUILD
