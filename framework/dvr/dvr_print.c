/* A comparison as text. */
#include "framework/dvr/dvr.h"

#include <stdio.h>

/* Of those that count, in millions per second. */
static double sampling_rate(const bb_dvr_result *result, const bb_contest_way *way)
{
    double rays = (double)result->pixels / result->pictures;
    return way->work * rays / bb_samples_median(&way->answer) / 1e3;
}

static void print_way(const bb_dvr_result *result, const bb_contest_way *way)
{
    if (!bb_contest_print_name(way))
        return;
    printf(" %9.1f", bb_samples_median(&way->answer));
    if (way->builder[0] == '\0') {
        printf(" %24s %9.1f %8.2f\n", "", way->work, sampling_rate(result, way));
        return;
    }
    bb_estimate with_build =
        bb_contest_ratio(bb_contest_base(result->ways, result->way_count), way, true);
    printf(" %7.3f", with_build.value);
    bb_contest_print_interval(with_build);
    printf(" %9.1f %8.2f %9.2g %u/255", way->work, sampling_rate(result, way), way->most,
           way->most_8);
    if (way->differ > 0)
        printf(", %llu pixels", (unsigned long long)way->differ);
    printf("\n");
}

static void print_errors(const bb_dvr_result *result)
{
    if (result->error_count == 0)
        return;
    printf("\n Accuracy of the march, against %g of its shortest step (which is converged to "
           "%.2g)\n",
           0.125, result->converged);
    printf("  step/%s   largest error         RMS   samples/ray   ms (last picture)\n",
           result->tets > 0 ? "width" : "voxel");
    for (uint32_t i = 0; i < result->error_count; i++) {
        const bb_dvr_error *e = &result->errors[i];
        printf("  %10g %15.3g %11.3g %13.1f %10.1f\n", e->step, e->most, e->rms, e->samples,
               bb_samples_median(&e->march));
    }
}

static void print_scene(const bb_dvr_result *r)
{
    printf("%s, transfer function %s\n", r->scene, r->transfer);
    if (r->tets > 0) {
        printf(" %u tetrahedra, %u on the boundary, %u vertices, field '%s'\n", r->tets,
               r->boundary, r->vertices, r->field);
        return;
    }
    printf(" %u x %u x %u voxels of %u bits, %.1f MiB in bricks of %u cells a side; %u of %u seen "
           "(%.2f %%)\n",
           r->dims[0], r->dims[1], r->dims[2], 8 * r->bytes, (double)r->volume_bytes / (1 << 20),
           r->brick_side, r->seen, r->bricks, 100.0 * r->seen / r->bricks);
}

static void print_ways(const bb_dvr_result *r)
{
    printf(" %u pictures, %llu pixels in all; ms per picture, medians of %u rounds\n\n",
           r->pictures, (unsigned long long)r->pixels, bb_contest_rounds(r->ways, r->way_count));
    printf(" %-38s%8s %8s %9s %7s %-16s %9s %8s %9s %s\n", "", "build", "layout", "picture", "all",
           r->tets > 0 ? "/first" : "/no tree", "samples", "M/s", "differs", "8 bits");
    for (uint32_t w = 0; w < r->way_count; w++)
        print_way(r, &r->ways[w]);
}

void bb_dvr_print(const bb_dvr_result *r)
{
    const bool mesh = r->tets > 0;
    print_scene(r);
    print_ways(r);
    printf(" all: build, layout and picture, by those of %s, paired round by round (95 %%);\n "
           "samples: per ray%s, and per second; differs: largest difference of a channel from that "
           "picture\n",
           mesh ? "the first way" : "the march without a tree", mesh ? ", in tetrahedra only" : "");
    if (!mesh)
        printf(" builders that do not read the volume itself get the boxes of what is seen, and "
               "find nothing out\n");
    printf("\n");
    if (mesh)
        bb_contest_print_trees(r->ways, r->way_count, r->tets);
    bb_contest_print_phases(r->ways, r->way_count);
    if (r->copy.count > 0)
        printf(" %-24s ms: %.3f, %.1f GB/s\n", "a copy of the bricks", bb_samples_median(&r->copy),
               (double)r->volume_bytes / 1e6 / bb_samples_median(&r->copy));
    print_errors(r);
    printf("\n");
}

static void print_error_line(const bb_dvr_result *r)
{
    if (r->error_count == 0)
        return;
    printf(" %-38s", "accuracy: step, RMS error, ms");
    for (uint32_t i = 0; i < r->error_count; i++)
        printf("%s %g: %.2g, %.0f", i > 0 ? ";" : "", r->errors[i].step, r->errors[i].rms,
               bb_samples_median(&r->errors[i].march));
    printf("\n");
}

void bb_dvr_print_briefly(const bb_dvr_result *r)
{
    print_scene(r);
    print_ways(r);
    print_error_line(r);
    printf("\n");
}
