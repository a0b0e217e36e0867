/* Reads the figures of a contender from results. */
#include "framework/advise/figures.h"

#include "traversal/traversal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

double bb_decided_number(const bb_entry *entry, const char *what)
{
    const double number = bb_get_decided(entry, what);
    return isfinite(number) ? number : 0;
}

uint32_t bb_kinds_in(const char *words)
{
    uint32_t count = words[0] != '\0';
    for (; *words != '\0'; words++)
        count += *words == '+';
    return count;
}

static bool is_text(const bb_entry *entry, bb_field_id field, const char *text)
{
    return strcmp(bb_get_text(entry, field), text) == 0;
}

static const bb_entry *find_build(const bb_image *image, const bb_contender *c)
{
    bb_each(build, bb_results_section(image->results, BB_BUILDS))
    {
        if (bb_run_of(build) == image->run && is_text(build, BB_F_BUILD_SCENE, image->scene) &&
            is_text(build, BB_F_BUILD_BUILDER, c->builder))
            return build;
    }
    return NULL;
}

static bool is_trace_of(const bb_entry *trace, const bb_entry *build, const bb_contender *c)
{
    return bb_build_of(trace) == build && is_text(trace, BB_F_TRACE_KERNEL, c->kernel) &&
           is_text(trace, BB_F_TRACE_INTERSECTOR, c->intersector);
}

/* Returns the number of ray sets of this trace's kind. *first: the trace is the first of them. */
static uint32_t sets_of_kind(const bb_image *image, const bb_entry *build, const bb_contender *c,
                             const bb_entry *of, bool *first)
{
    const char *rays = bb_get_text(of, BB_F_TRACE_RAYS);
    uint32_t count = 0;
    *first = false;
    bb_each(trace, bb_results_section(image->results, BB_TRACES))
    {
        if (!is_trace_of(trace, build, c) || !is_text(trace, BB_F_TRACE_RAYS, rays))
            continue;
        *first = *first || (count == 0 && trace == of);
        count++;
    }
    return count;
}

/* Adds the samples of a trace, scaled to `rays` rays. Returns false if their rounds do not match.
 */
static bool add_trace(const bb_entry *trace, double rays, bb_tried_figures *f)
{
    bb_samples ms;
    double factor = rays / bb_get_number(trace, BB_F_TRACE_COUNT);
    if (!bb_get_samples(trace, BB_F_TRACE_MS, &ms) || ms.count != f->cost.count)
        return false;
    for (uint32_t i = 0; i < ms.count; i++)
        f->cost.values[i] += factor * ms.values[i];
    f->trace_ms += factor * bb_samples_median(&ms);
    f->rays += bb_get_number(trace, BB_F_TRACE_COUNT);
    double checked = bb_get_number(trace, BB_F_ACCURACY_CHECKED);
    double ppm = bb_get_number(trace, BB_F_ACCURACY_WRONG_PPM);
    double unlike = bb_get_number(trace, BB_F_TRACE_UNLIKE);
    if (checked > 0 && isfinite(ppm)) {
        f->checked += checked;
        f->wrong += round(ppm * checked / 1e6);
    } else if (unlike > 0) {
        f->unlike += unlike;
    }
    return true;
}

/* Adds the simulation of a trace, scaled to `rays` rays. Returns false if there is none. */
static bool add_simulation(const bb_image *image, const bb_entry *trace, double rays,
                           bb_tried_figures *f)
{
    bb_simulation simulation;
    if (!bb_get_simulation(trace, image->simulation, &simulation))
        return false;
    bb_simulated_add(&f->simulated, rays, &simulation);
    return true;
}

static void say(bb_tried_figures *f, const char *what, const bb_entry *entry, bb_field_id reason)
{
    snprintf(f->reason, sizeof f->reason, "%s: %s", what, bb_get_text(entry, reason));
}

static uint32_t count_kinds(const bb_image *image, const bb_entry *build, const bb_contender *c)
{
    uint32_t kinds = 0;
    bb_each(trace, bb_results_section(image->results, BB_TRACES))
    {
        bool first;
        if (!is_trace_of(trace, build, c))
            continue;
        sets_of_kind(image, build, c, trace, &first);
        kinds += first;
    }
    return kinds;
}

static bool read_traces(const bb_image *image, const bb_entry *build, const bb_contender *c,
                        bb_tried_figures *f)
{
    const uint32_t kinds = count_kinds(image, build, c);
    bb_each(trace, bb_results_section(image->results, BB_TRACES))
    {
        bool first;
        if (!is_trace_of(trace, build, c))
            continue;
        if (!bb_is_ok(trace)) {
            say(f, bb_get_text(trace, BB_F_TRACE_RAYS), trace, BB_F_TRACE_REASON);
            return false;
        }
        uint32_t sets = sets_of_kind(image, build, c, trace, &first);
        if (!add_trace(trace, image->rays / kinds / sets, f)) {
            snprintf(f->reason, sizeof f->reason, "%s: not all rounds were measured",
                     bb_get_text(trace, BB_F_TRACE_RAYS));
            return false;
        }
        if (image->simulation != NULL &&
            !add_simulation(image, trace, image->rays / kinds / sets, f)) {
            snprintf(f->reason, sizeof f->reason, "%s: not simulated",
                     bb_get_text(trace, BB_F_TRACE_RAYS));
            return false;
        }
        if (f->trace == NULL)
            f->trace = trace;
    }
    if (f->trace == NULL)
        snprintf(f->reason, sizeof f->reason, "it traced none of the rays");
    return f->trace != NULL;
}

static double or_zero(double value)
{
    return isfinite(value) ? value : 0;
}

static uint32_t width_of(const char *kernel)
{
    bb_spec spec;
    const bb_kernel *found;
    if (bb_kernel_parse(kernel, &spec, &found) != BB_OK)
        return 0;
    const bb_layout *layout = bb_layout_find(found->layout);
    return layout != NULL ? layout->width : 0;
}

static void read_extent(const bb_image *image, const bb_contender *c, bb_tried_figures *f)
{
    f->bytes_tree = image->factor * bb_get_number(f->build, BB_F_TREE_BYTES);
    f->bytes_build = image->factor * bb_get_number(f->build, BB_F_TREE_BYTES_PEAK);
    f->bytes_layout = image->factor * bb_get_named(f->build, BB_F_BUILD_LAYOUTS_BYTES,
                                                   bb_get_text(f->trace, BB_F_TRACE_LAYOUT));
    f->extent = (bb_extent){
        .bytes = f->bytes_build + f->bytes_layout,
        .code_bits = (uint32_t)bb_decided_number(f->build, BB_DECIDED_CODE_BITS),
        .stack = (uint32_t)bb_decided_number(f->trace, BB_DECIDED_STACK),
        .kinds = bb_kinds_in(bb_get_decision(f->trace, BB_DECIDED_KINDS)),
        .width = width_of(c->kernel),
        .doubt = bb_intersector_doubt(c->intersector),
        .ms = f->build_ms + f->layout_ms + f->trace_ms,
    };
}

/* Puts the time of the rays by their bound in place of what was measured. */
static void take_simulation(bb_tried_figures *f)
{
    const double ms = f->simulated.rays / bb_simulated_sum(&f->simulated).mrays_s / 1e3;
    f->cost = (bb_samples){.count = 1, .values = {ms}};
    f->extent.ms = ms;
}

void bb_tried_read(const bb_image *image, const bb_contender *c, bb_tried_figures *f)
{
    *f = (bb_tried_figures){.build = find_build(image, c)};
    if (f->build == NULL || !bb_is_ok(f->build)) {
        say(f, "build", f->build, BB_F_BUILD_REASON);
        return;
    }
    if (!bb_get_samples(f->build, BB_F_BUILD_MS, &f->cost)) {
        snprintf(f->reason, sizeof f->reason, "it was not built");
        return;
    }
    double before = or_zero(bb_get_number(f->build, BB_F_BUILD_BOXES_MS)) +
                    or_zero(bb_get_number(f->build, BB_F_BUILD_TRANSFER_MS));
    for (uint32_t i = 0; i < f->cost.count; i++)
        f->cost.values[i] = image->factor * (f->cost.values[i] + before);
    f->build_ms = bb_samples_median(&f->cost);
    if (!read_traces(image, f->build, c, f))
        return;
    f->layout_ms = image->factor * bb_get_named(f->build, BB_F_BUILD_LAYOUTS_MS,
                                                bb_get_text(f->trace, BB_F_TRACE_LAYOUT));
    for (uint32_t i = 0; i < f->cost.count; i++)
        f->cost.values[i] += f->layout_ms;
    f->measured = isfinite(f->layout_ms);
    if (!f->measured)
        snprintf(f->reason, sizeof f->reason, "its layout was not measured");
    read_extent(image, c, f);
    if (image->simulation != NULL)
        take_simulation(f);
}
