/* Predicts sizes of contenders, and fills turns. */
#include "framework/advise/turns.h"

#include <math.h>
#include <string.h>

/* Returns the peak of a build plus the copy that the harness checks. */
static double build_bytes(const bb_tried_figures *f)
{
    return f->bytes_build + f->bytes_tree;
}

static double layout_bytes(const bb_tried_figures *f)
{
    return f->bytes_layout;
}

static const char *builder_of(const bb_contender *who)
{
    return who->builder;
}

static const char *kernel_of(const bb_contender *who)
{
    return who->kernel;
}

/* Returns the largest size of the scouts of this name, else of all scouts. */
static double size_of(const bb_sizes *sizes, const char *name,
                      const char *(*name_of)(const bb_contender *who),
                      double (*bytes)(const bb_tried_figures *f))
{
    double own = 0, most = 0;
    for (int k = 0; k < 2; k++)
        for (uint32_t i = 0; i < sizes->scouts[k]->count; i++) {
            const bb_tried_figures *f = &sizes->scouts[k]->figures[i];
            if (!f->measured)
                continue;
            most = fmax(most, bytes(f));
            if (strcmp(name_of(&sizes->scouts[k]->who[i]), name) == 0)
                own = fmax(own, bytes(f));
        }
    return own > 0 ? own : most;
}

double bb_size_of_build(const bb_sizes *sizes, const char *builder)
{
    return size_of(sizes, builder, builder_of, build_bytes);
}

double bb_size_of_layout(const bb_sizes *sizes, const char *kernel)
{
    return size_of(sizes, kernel, kernel_of, layout_bytes);
}

/* Returns the memory that one more contender adds. Contenders share trees and layouts. */
static double more_bytes(const bb_entered *field, const bb_sizes *sizes, const bool *in, uint32_t i)
{
    bool built = false, laid_out = false;
    for (uint32_t k = 0; k < field->count; k++) {
        if (!in[k] || strcmp(field->who[k].builder, field->who[i].builder) != 0)
            continue;
        built = true;
        laid_out = laid_out || strcmp(field->who[k].kernel, field->who[i].kernel) == 0;
    }
    return (built ? 0 : bb_size_of_build(sizes, field->who[i].builder)) +
           (laid_out ? 0 : bb_size_of_layout(sizes, field->who[i].kernel));
}

uint32_t bb_turn(const bb_entered *field, uint32_t reference, const bb_sizes *sizes,
                 const bool *done, bool *in)
{
    uint32_t count = 0;
    double bytes = 0;
    memset(in, 0, field->count * sizeof *in);
    if (reference == BB_NO_RACER)
        return 0;
    if (sizes != NULL)
        bytes = more_bytes(field, sizes, in, reference);
    in[reference] = true;
    count += !done[reference];
    const uint32_t alone = count;
    for (uint32_t i = 0; i < field->count; i++) {
        if (field->racers[i].state != BB_RACING || done[i] || in[i])
            continue;
        const double more = sizes != NULL ? more_bytes(field, sizes, in, i) : 0;
        if (sizes != NULL && bytes + more > sizes->room && count > alone)
            continue;
        in[i] = true;
        bytes += more;
        count++;
    }
    return count;
}
