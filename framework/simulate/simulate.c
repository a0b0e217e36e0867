#include "framework/simulate/simulate.h"

#include "framework/base/arithmetic.h"
#include "framework/base/memory.h"
#include "framework/simulate/costs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Groups that each simulated unit runs in turn, at least: its first cache is then as full as in the
 * midst of a large set. A sample that is too small for this on all units runs on fewer. */
enum { TURNS = 4, GROUP_MOST = 1024 };

const bb_option bb_simt_options[] = {
    {"device", "h100", NULL, "a GPU on paper: a name of devices/, or a file that ends in .json"},
    {"width", "32", "32|64", "rays of a group that run in lockstep"},
    {"cache", "1", "0.25|0.5|1|2|4", "both caches are so many times as large"},
    {.name = NULL},
};

bool bb_is_simt(const char *text)
{
    const size_t length = sizeof BB_SIMT - 1;
    return strncmp(text, BB_SIMT, length) == 0 && (text[length] == '\0' || text[length] == ':');
}

static bb_status parse(const char *text, bb_simt *simt)
{
    bb_spec spec;
    BB_TRY(bb_spec_parse(text, &spec));
    BB_TRY(bb_spec_validate(&spec, bb_simt_options, "metric"));
    const char *device = bb_spec_value(&spec, bb_simt_options, "device");
    const char *width = bb_spec_value(&spec, bb_simt_options, "width");
    BB_TRY(bb_description_read(device, &simt->device));
    simt->width = (uint32_t)strtoul(width, NULL, 10);
    const char *cache = bb_spec_value(&spec, bb_simt_options, "cache");
    const double factor = strtod(cache, NULL);
    simt->device.first_bytes *= factor;
    simt->device.second_bytes *= factor;
    snprintf(simt->name, sizeof simt->name, BB_SIMT ":device=%s,width=%u%s%s", simt->device.name,
             simt->width, factor != 1 ? ",cache=" : "", factor != 1 ? cache : "");
    return BB_OK;
}

bb_status bb_simts_parse(char *const *metrics, uint32_t metric_count, bb_simt simts[BB_SIMT_MAX],
                         uint32_t *count)
{
    *count = 0;
    for (uint32_t i = 0; i < metric_count; i++) {
        if (!bb_is_simt(metrics[i]))
            continue;
        if (*count == BB_SIMT_MAX)
            return bb_fail(BB_INVALID, "at most %d simulations at once", BB_SIMT_MAX);
        BB_TRY(parse(metrics[i], &simts[*count]));
        for (uint32_t k = 0; k < *count; k++)
            if (strcmp(simts[k].name, simts[*count].name) == 0)
                return bb_fail(BB_INVALID, "--metrics: %s is given twice", simts[k].name);
        ++*count;
    }
    return BB_OK;
}

const char *bb_binding_word(bb_binding binding)
{
    static const char *const words[] = {"issue", "L1", "L2", "memory"};
    return words[binding];
}

bb_binding bb_binding_of(const char *word)
{
    uint32_t binding = 0;
    while (binding < BB_BINDINGS && strcmp(word, bb_binding_word((bb_binding)binding)) != 0)
        binding++;
    return (bb_binding)binding;
}

/* Returns how many units are simulated. A sample runs on its share of the units that its set fills,
 * so that each unit gets as many groups as from the whole set. */
static uint32_t units_for(const bb_description *d, uint32_t width, uint32_t in_flight,
                          const bb_steps *steps)
{
    const uint32_t filled = bb_divide_up(steps->set_rays, width) / (TURNS * in_flight);
    const double used = fmin(fmax(filled, 1), d->units);
    return (uint32_t)fmax(round(used * steps->rays / steps->set_rays), 1);
}

/* All units of a device share the layout in its second cache, so simulated ones have the room for
 * all of it; of the rest they have their part. */
static bb_machine machine_for(const bb_description *d, const bb_footing *footing, uint32_t width,
                              uint32_t in_flight, const bb_steps *steps)
{
    const uint32_t units = units_for(d, width, in_flight, steps);
    const double layout = (double)(footing->nodes_bytes + footing->prims_bytes);
    const double shared = fmin(layout, d->second_bytes);
    const double part = (d->second_bytes - shared) * units / d->units;
    return (bb_machine){.width = width,
                        .units = units,
                        .in_flight = in_flight,
                        .first_bytes = (uint64_t)d->first_bytes,
                        .first_ways = (uint32_t)d->first_ways,
                        .second_bytes = (uint64_t)(shared + part),
                        .second_ways = (uint32_t)d->second_ways};
}

static double share(uint64_t part, uint64_t whole)
{
    return whole > 0 ? (double)part / (double)whole : (double)NAN;
}

static bb_issued sum_of(const bb_issued *a, const bb_issued *b)
{
    return (bb_issued){.count = a->count + b->count,
                       .lanes = a->lanes + b->lanes,
                       .sectors = a->sectors + b->sectors,
                       .lines = a->lines + b->lines};
}

static void find_figures(const bb_simt *simt, bb_simulation *s)
{
    const bb_traffic *t = &s->traffic;
    const bb_issued nodes = sum_of(&t->issued[BB_STEP_NODE], &t->issued[BB_STEP_BOX]);
    const bb_issued *prims = &t->issued[BB_STEP_PRIMS];
    const bb_issued *pushes = &t->issued[BB_STEP_PUSH], *pops = &t->issued[BB_STEP_POP];
    s->node_efficiency = bb_efficiency(&nodes, simt->width);
    s->prim_efficiency = bb_efficiency(prims, simt->width);
    s->sample_efficiency = bb_efficiency(&t->issued[BB_STEP_SAMPLE], simt->width);
    s->steps = share(t->ray_steps, t->rays);
    s->lines = share(nodes.lines + prims->lines, nodes.count + prims->count);
    s->stack_bytes = share((pushes->sectors + pops->sectors) * BB_SECTOR_BYTES, t->rays);
    s->l1_hits = share(t->first_hits, t->first);
    s->l2_hits = share(t->second_hits, t->second);
    s->memory_bytes = share((t->read + t->written) * BB_SECTOR_BYTES, t->rays);
    s->rays = (double)t->rays;
}

/* Returns the bound, in Mrays/s, if the units do so much of what takes `seconds` in all. */
static double bound(const bb_simulation *s, double seconds)
{
    return seconds > 0 ? s->rays / seconds / 1e6 : (double)INFINITY;
}

static void find_issue(const bb_simt *simt, const bb_costs *costs, bb_simulation *s)
{
    const bb_description *d = &simt->device;
    const bb_traffic *t = &s->traffic;
    const double clock = d->clock_ghz * 1e9, turns = ceil(simt->width / d->lanes);
    double instructions = 0, active = 0;
    for (uint32_t k = 0; k < BB_ISSUE_KINDS; k++) {
        const double in_regions = costs->in_regions[k] - costs->instructions[k];
        instructions += (double)t->issued[k].count * costs->instructions[k] +
                        (double)t->in_regions[k].count * in_regions;
        active += (double)t->issued[k].lanes * costs->instructions[k] +
                  (double)t->in_regions[k].lanes * in_regions;
    }
    s->efficiency = instructions > 0 ? active / (instructions * simt->width) : (double)NAN;
    s->issue_mrays_s = bound(s, instructions * turns / (d->units * d->issues_per_clock * clock));
}

static void find_bounds(const bb_simt *simt, bb_simulation *s)
{
    const bb_description *d = &simt->device;
    const bb_traffic *t = &s->traffic;
    const double clock = d->clock_ghz * 1e9;
    s->l1_mrays_s = bound(s, (double)t->first * BB_SECTOR_BYTES /
                                 (d->units * d->first_bytes_per_clock * clock));
    s->l2_mrays_s = bound(s, (double)(t->second + t->second_written) * BB_SECTOR_BYTES /
                                 (d->second_bytes_per_clock * clock));
    s->memory_mrays_s = bound(s, s->memory_bytes * s->rays / (d->memory_gb_s * 1e9));
}

static void find_least(bb_simulation *s)
{
    const double bounds[BB_BINDINGS] = {[BB_BY_ISSUE] = s->issue_mrays_s,
                                        [BB_BY_FIRST] = s->l1_mrays_s,
                                        [BB_BY_SECOND] = s->l2_mrays_s,
                                        [BB_BY_MEMORY] = s->memory_mrays_s};
    s->binds = BB_BY_ISSUE;
    for (int i = 0; i < BB_BINDINGS; i++)
        s->binds = bounds[i] < bounds[s->binds] ? (bb_binding)i : s->binds;
    s->mrays_s = bounds[s->binds];
}

/* What the table's programs begin with that trace primitives of these kinds; NULL: it has none. */
static const char *programs_of(uint32_t kinds)
{
    return kinds == BB_TRIANGLES ? "" : kinds == BB_SPHERES ? "spheres/" : NULL;
}

/* A packet is the work of one work-item, whose code says nothing of that of a ray on each lane. */
bool bb_simulates_bounds(const bb_kernel *kernel, uint32_t kinds)
{
    return programs_of(kinds) != NULL && kernel->control != BB_CONTROL_UNKNOWN &&
           kernel->control != BB_PACKETS;
}

void bb_simulated_code_release(bb_simulated_code *code)
{
    bb_host_free(code->listed);
    code->listed = NULL;
}

/* Steps name nodes and primitives by numbers of BB_STEP_INDEX_BITS. */
static bool can_name(uint64_t bytes, uint32_t each)
{
    return each == 0 || bytes / each <= BB_STEP_INDEX_MASK;
}

bb_status bb_simulate_code(const bb_simt *simt, const bb_simulated_code *code,
                           const bb_steps *steps, bb_simulation *simulation)
{
    bb_costs costs = {.counted = false};
    const uint32_t group = code->footing.group;
    if (group > GROUP_MOST || (group % BB_STEPS_RUN != 0 && BB_STEPS_RUN % group != 0))
        return bb_fail(BB_UNSUPPORTED,
                       "work-groups of %u rays are not simulated: only those that divide %d, or "
                       "multiples of it up to %d",
                       group, BB_STEPS_RUN, GROUP_MOST);
    if (!can_name(code->footing.nodes_bytes, code->footing.node_bytes) ||
        !can_name(code->footing.prims_bytes, code->footing.prim_bytes))
        return bb_fail(BB_UNSUPPORTED, "more than %u nodes or primitives: steps cannot name them",
                       BB_STEP_INDEX_MASK);
    if (code->kernel != NULL)
        BB_TRY(bb_costs_find(code->program, code->kernel, simt->device.code, &costs));
    const uint32_t in_flight =
        bb_description_in_flight(&simt->device, costs.registers, simt->width);
    const bb_machine machine =
        machine_for(&simt->device, &code->footing, simt->width, in_flight, steps);
    *simulation = (bb_simulation){.in_flight = in_flight,
                                  .mrays_s = (double)NAN,
                                  .issue_mrays_s = (double)NAN,
                                  .efficiency = (double)NAN};
    BB_TRY(bb_machine_run(&machine, &code->footing, steps, &simulation->traffic));
    if (simulation->traffic.left > 0)
        return bb_fail(BB_FAILED, "%llu of %u recorded steps do not fit the kernel's loops",
                       (unsigned long long)simulation->traffic.left, steps->ends[steps->rays - 1]);
    find_figures(simt, simulation);
    find_bounds(simt, simulation);
    if (costs.counted) {
        find_issue(simt, &costs, simulation);
        find_least(simulation);
    }
    return BB_OK;
}

bb_status bb_simulate(const bb_simt *simt, const bb_traverser_request *request,
                      const bb_layout_data *layout, const bb_steps *steps,
                      bb_simulation *simulation)
{
    bb_simulated_code code = {.footing = bb_footing_of(request, layout)};
    if (!bb_intersector_is_exact(request->intersector))
        return bb_fail(BB_UNSUPPORTED, "kernels/isa.tsv has the code of `exact` alone, not of %s",
                       request->intersector->name);
    if (bb_simulates_bounds(request->kernel, layout->kinds)) {
        code.kernel = "trace";
        snprintf(code.program, sizeof code.program, "%s%.500s", programs_of(layout->kinds),
                 request->spec->text);
    }
    return bb_simulate_code(simt, &code, steps, simulation);
}
