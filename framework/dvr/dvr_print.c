/* A comparison as text. */
#include "framework/dvr/dvr.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void put_interval(bb_estimate e, const char *format)
{
    char text[64];
    if (isnan(e.low))
        snprintf(text, sizeof text, "[too few rounds]");
    else
        snprintf(text, sizeof text, format, e.low, e.high);
    printf(" %-16s", text);
}

static void print_way(const bb_dvr_result *result, const bb_dvr_way *way)
{
    char name[96];
    bool without = way->builder[0] == '\0';
    snprintf(name, sizeof name, "%s, %s", way->builder, way->kernel);
    printf(" %-38s", without ? "no tree" : name);
    if (way->refused[0] != '\0') {
        printf(" %s\n", way->refused);
        return;
    }
    if (without)
        printf("%8s %8s", "", "");
    else
        printf("%8.2f %8.2f", bb_samples_median(&way->build), bb_samples_median(&way->layout));
    printf(" %9.1f", bb_samples_median(&way->march));
    if (without) {
        printf(" %24s %9.1f\n", "", way->samples);
        return;
    }
    bb_estimate with_build = bb_dvr_ratio(result, way, true);
    printf(" %7.3f", with_build.value);
    put_interval(with_build, "[%.3f, %.3f]");
    printf(" %9.1f %9.2g %u/255", way->samples, way->most, way->most_8);
    if (way->differ > 0)
        printf(", %llu pixels", (unsigned long long)way->differ);
    printf("\n");
}

static void print_phases(const bb_dvr_result *result)
{
    const char *last = "";
    for (uint32_t w = 1; w < result->way_count; w++) {
        const bb_dvr_way *way = &result->ways[w];
        if (way->phase_count == 0 || strcmp(way->builder, last) == 0)
            continue;
        last = way->builder;
        printf(" %-24s ms: ", way->builder);
        for (uint32_t p = 0; p < way->phase_count; p++)
            printf("%s%s %.3f", p > 0 ? ", " : "", way->phases[p].name,
                   bb_samples_median(&way->phases[p].ms));
        printf("\n");
    }
}

static void print_errors(const bb_dvr_result *result)
{
    if (result->error_count == 0)
        return;
    printf("\n Accuracy of the march, against %g of its shortest step (which is converged to "
           "%.2g)\n",
           0.125, result->converged);
    printf("  step/voxel   largest error         RMS   samples/ray   ms (last picture)\n");
    for (uint32_t i = 0; i < result->error_count; i++) {
        const bb_dvr_error *e = &result->errors[i];
        printf("  %10g %15.3g %11.3g %13.1f %10.1f\n", e->step, e->most, e->rms, e->samples,
               bb_samples_median(&e->march));
    }
}

void bb_dvr_print(const bb_dvr_result *r)
{
    printf("%s, transfer function %s\n", r->scene, r->transfer);
    printf(" %u x %u x %u voxels of %u bits, %.1f MiB in bricks of %u cells a side; %u of %u seen "
           "(%.2f %%)\n",
           r->dims[0], r->dims[1], r->dims[2], 8 * r->bytes, (double)r->volume_bytes / (1 << 20),
           r->brick_side, r->seen, r->bricks, 100.0 * r->seen / r->bricks);
    printf(" %u pictures, %llu pixels in all; ms per picture, medians of %u rounds\n\n",
           r->pictures, (unsigned long long)r->pixels,
           r->ways[0].march.count > 1 ? r->ways[0].march.count - 1 : 1);
    printf(" %-38s%8s %8s %9s %7s %-16s %9s %9s %s\n", "", "build", "layout", "picture", "all",
           "/no tree", "samples", "differs", "8 bits");
    for (uint32_t w = 0; w < r->way_count; w++)
        print_way(r, &r->ways[w]);
    printf(" all: build, layout and picture, by the march without a tree, paired round by round "
           "(95 %%);\n samples: per ray; differs: largest difference of a channel from the picture "
           "without a tree;\n builders other than vlbvh get the boxes of what is seen, and find "
           "nothing out themselves\n\n");
    print_phases(r);
    if (r->copy.count > 0)
        printf(" %-24s ms: %.3f, %.1f GB/s\n", "a copy of the bricks", bb_samples_median(&r->copy),
               (double)r->volume_bytes / 1e6 / bb_samples_median(&r->copy));
    print_errors(r);
    printf("\n");
}
