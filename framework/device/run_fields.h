/* What a table says of its whole run, one row for each column, in the order in which they are
 * written:
 *
 *   RUN(id, name, unit, kind, sense, format, decimals, heading, help)
 *
 * `id` is BB_RUN_id of bb_run_columns; the others as in framework/table/table.h. Of results these
 * are the fields of the context (framework/record/fields.h), which use `format`; a FLAG is a text,
 * and a SIGNED number may be negative.
 *
 * This file has no guard: whoever includes it defines RUN for its own purpose.
 */
/* clang-format off */
RUN(DATE, "date", "", TEXT, TIMED, AS_TEXT, 0, "Date", "When the run began, UTC.")
RUN(REVISION, "revision", "", TEXT, EXACT, AS_TEXT, 0, "Revision", "The program's revision.")
RUN(VERSION, "version", "", TEXT, EXACT, AS_TEXT, 0, "Version", "The program's version.")
RUN(HOST, "host", "", TEXT, EXACT, AS_TEXT, 0, "Host", "The machine's name.")
RUN(CPU, "cpu", "", TEXT, EXACT, AS_TEXT, 0, "Processor", "The machine's processor.")
RUN(THREADS, "cpu_threads", "", NUMBER, EXACT, AS_WHOLE, 0, "Threads", "Of the processor.")
RUN(GOVERNOR, "governor", "", TEXT, EXACT, AS_TEXT, 0, "Governor", "Of the processors' clocks.")
RUN(SMT, "smt", "", TEXT, EXACT, AS_TEXT, 0, "SMT", "on: a core runs several threads; or off.")
RUN(BOOST, "boost", "", TEXT, EXACT, AS_TEXT, 0, "Boost", "Of the clocks: on or off.")
RUN(PROCESSORS, "processors", "", TEXT, EXACT, AS_TEXT, 0, "Processors used",
    "Those that the process may run on: a list, or all.")
RUN(LOAD_1, "load_1", "", NUMBER, TIMED, AS_FIGURE, 2, "Load, 1 min", "Before the run.")
RUN(LOAD_5, "load_5", "", NUMBER, TIMED, AS_FIGURE, 2, "Load, 5 min", "Before the run.")
RUN(LOAD_15, "load_15", "", NUMBER, TIMED, AS_FIGURE, 2, "Load, 15 min", "Before the run.")
RUN(OTHERS, "busy_processors", "", NUMBER, TIMED, AS_FIGURE, 2, "Processors kept busy",
    "By other programs.")
RUN(DEVICE, "device", "", TEXT, EXACT, AS_TEXT, 0, "Device", "The OpenCL device.")
RUN(DEVICE_TYPE, "device_type", "", TEXT, EXACT, AS_TEXT, 0, "Device type",
    "CPU, or GPU for all other devices.")
RUN(DRIVER, "driver", "", TEXT, EXACT, AS_TEXT, 0, "Driver", "The OpenCL driver's version.")
RUN(OPENCL, "opencl", "", TEXT, EXACT, AS_TEXT, 0, "OpenCL", "The OpenCL version of the device.")
RUN(UNITS, "compute_units", "", NUMBER, EXACT, AS_WHOLE, 0, "Compute units", "Of the device.")
RUN(FLOATS, "float_config", "", TEXT, EXACT, AS_TEXT, 0, "Floats of the device",
    "In OpenCL's words.")
RUN(HANDOVER, "handover", "", TEXT, EXACT, AS_TEXT, 0, "Handover",
    "How work-groups hand over data.")
RUN(LITMUS, "litmus_messages", "", NUMBER, EXACT, AS_WHOLE, 0, "Litmus messages",
    "That the fence was tested by.")
RUN(STALE, "litmus_stale", "", NUMBER, EXACT, AS_WHOLE, 0, "Stale", "Of the messages.")
RUN(KERNELS, "kernels", "", TEXT, EXACT, AS_TEXT, 0, "Kernels", "Where the device code comes from.")
RUN(PROGRAMS, "programs", "", NUMBER, EXACT, AS_WHOLE, 0, "Programs compiled",
    "programs of device code")
RUN(COMPILE, "compile_ms", "ms", NUMBER, TIMED, AS_FIGURE, -1, "Compiling",
    "wall time of the driver's compiler, without what it leaves for first launches")
RUN(LAUNCH, "launch_us", "us", NUMBER, TIMED, AS_FIGURE, -1, "Empty launch",
    "Of a kernel that does nothing, enqueued among others.")
RUN(CACHE, "kernel_cache", "", TEXT, EXACT, AS_TEXT, 0, "Kernel cache",
    "cold: compiled again, the slowest program takes less than a third of the time; warm: it does "
    "not, so it came from the driver's cache, or there is none")
RUN(EMBREE, "embree_version", "", TEXT, EXACT, AS_TEXT, 0, "Embree", "The library that was loaded.")
RUN(EMBREE_API, "embree_api", "", TEXT, EXACT, AS_TEXT, 0, "Embree's calls", "That trace.")
RUN(FLAGS, "build_flags", "", TEXT, EXACT, AS_TEXT, 0, "Build flags",
    "How the program was compiled.")
RUN(SEED, "seed", "", TEXT, EXACT, AS_TEXT, 0, "Seed", "The random seed.")
RUN(COMMAND, "command", "", TEXT, EXACT, AS_TEXT, 0, "Command", "The command line.")
RUN(SHARD, "shard", "", TEXT, EXACT, AS_TEXT, 0, "Shard", "which part of the cells, of how many")
RUN(SHARD_OF, "shard_of", "", TEXT, EXACT, AS_TEXT, 0, "Shard of", "Hash of the whole request.")
RUN(SHARDS, "shards", "", TEXT, EXACT, AS_TEXT, 0, "Merged from",
    "shards of one run, with their hosts")
RUN(REDUCED_TO, "reduced_to", "", TEXT, EXACT, AS_TEXT, 0, "Reduced to",
    "To keep the time of --time.")
RUN(SETS, "planned_sets", "", NUMBER, EXACT, AS_WHOLE, 0, "Planned ray sets",
    "To be traced, by scenes, views and workloads.")
RUN(CELLS, "planned_cells", "", NUMBER, EXACT, AS_WHOLE, 0, "Planned cells",
    "To be measured in these sets, by builders, kernels and intersectors.")
RUN(INTERRUPTED, "interrupted", "", FLAG, EXACT, AS_TEXT, 0, "Interrupted",
    "yes: not all was measured.")
RUN(AUDIT_TIMINGS, "timings", "", NUMBER, TIMED, AS_FIGURE, 0, "Timings checked",
    "By a second clock.")
RUN(AUDIT_RATES, "rates", "", NUMBER, TIMED, AS_FIGURE, 0, "Rates checked", "By the rays launched.")
RUN(AUDIT_REST, "rest_ms", "ms", SIGNED | NUMBER, TIMED, AS_FIGURE, -1, "Rest",
    "Of the run that nothing accounts for.")
RUN(AUDIT_COMPLAINTS, "clock_complaints", "", NUMBER, TIMED, AS_FIGURE, 0,
    "Contradictions of clocks", "Of these timings.")
RUN(AUDIT_TEXTS, "clock_complaint", "", TEXT, EXACT, AS_TEXT, 0, "First contradiction", "In words.")
#undef RUN
/* clang-format on */
