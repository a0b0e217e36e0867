/* An animation in a terminal. */
#include "framework/animate/animate.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double counts[] = {1e5, 1e7, 1e9};

enum { COUNTS = sizeof counts / sizeof counts[0] };

static void print_ways(const bb_animate_sums *sums)
{
    char text[64] = "";
    size_t used = 0;
    for (int way = BB_KEPT; way <= BB_REBUILT; way++)
        if (sums->ways[way] > 0 && used < sizeof text)
            used +=
                (size_t)snprintf(text + used, sizeof text - used, "%s%u %s", used > 0 ? ", " : "",
                                 sums->ways[way], bb_update_word((bb_update_way)way));
    printf("  %s", text);
}

static void print_methods(const bb_animate_result *result)
{
    printf("  %-36s %10s %10s %8s %9s %9s %9s %9s", "method", "update ms", "worst", "in frame",
           "transfer", "SAH/best", "most", "drift");
    for (uint32_t i = 0; i < result->yardstick_count; i++)
        printf(" %7s/%-.8s", "most", result->yardsticks[i]);
    printf(" %9s  frames\n", "wrong");
    for (uint32_t m = 0; m < result->method_count; m++) {
        const bb_animate_method *method = &result->methods[m];
        bb_animate_sums s = bb_animate_sum(result, method);
        printf("  %-36s ", method->builder);
        if (s.frames > 0) {
            printf("%10.3f %10.3f %8u %9.3f %9.3f %9.3f %9.4f", s.update, s.worst_update,
                   s.worst_frame, s.transfer, s.sah_mean, s.sah_most, s.drift);
            for (uint32_t i = 0; i < result->yardstick_count; i++)
                printf(" %*.3f", 8 + (int)strlen(result->yardsticks[i]), s.fresh_most[i]);
            printf(" %9llu", (unsigned long long)s.wrong);
            print_ways(&s);
        }
        printf("%s%s\n", s.frames > 0 && method->refused[0] != '\0' ? "; then " : "",
               method->refused);
    }
}

static void print_kernels(const bb_animate_result *result)
{
    printf("\n  %-36s %-16s %10s %9s", "method", "kernel", "layout ms", "in place");
    for (uint32_t i = 0; i < result->ray_count; i++)
        printf(" %14.14s", result->rays[i]);
    printf("  Mrays/s\n");
    for (uint32_t m = 0; m < result->method_count; m++) {
        const bb_animate_method *method = &result->methods[m];
        bb_animate_sums s = bb_animate_sum(result, method);
        for (uint32_t k = 0; k < result->kernel_count && s.frames > 0; k++) {
            printf("  %-36s %-16s %10.3f %4u/%-4u", k == 0 ? method->builder : "",
                   result->kernels[k], s.layout[k], s.in_place[k], s.frames);
            for (uint32_t i = 0; i < result->ray_count; i++)
                printf(" %14.3f", s.rays[i] / s.rays_ms[k][i] / 1e3);
            printf("\n");
        }
    }
}

static void print_winners(const bb_animate_result *result)
{
    printf("\n  who wins, by rays per frame: update, layout and tracing together, in ms\n");
    for (uint32_t i = 0; i < result->ray_count; i++)
        for (int n = 0; n < COUNTS; n++) {
            uint32_t kernel = 0, winner = bb_animate_winner(result, i, counts[n]);
            if (winner == BB_NONE)
                continue;
            const bb_animate_method *method = &result->methods[winner];
            double ms = bb_animate_frame_ms(result, method, i, counts[n], &kernel);
            printf("  %-14.14s %6.0e  %12.1f  %s, %s\n", result->rays[i], counts[n], ms,
                   method->builder, result->kernels[kernel]);
        }
}

static void print_intervals(const char *rays, const bb_animate_interval *intervals, uint32_t count)
{
    printf("  %s: %s", rays, count == 0 ? "none" : "");
    for (uint32_t i = 0; i < count; i++) {
        printf("%s", i > 0 ? " and " : "");
        if (intervals[i].from == 0 && isinf(intervals[i].to))
            printf("any");
        else if (intervals[i].from == 0)
            printf("below %.3g", intervals[i].to);
        else if (isinf(intervals[i].to))
            printf("above %.3g", intervals[i].from);
        else
            printf("%.3g to %.3g", intervals[i].from, intervals[i].to);
    }
}

static void print_faster(const bb_animate_result *result)
{
    const bb_animate_method *with = bb_animate_rebuilder(result);
    if (with == NULL || result->method_count < 2)
        return;
    printf("\n  rays per frame for which a method is faster than %s\n", with->builder);
    for (uint32_t m = 0; m < result->method_count; m++) {
        const bb_animate_method *method = &result->methods[m];
        if (method == with || method->done < 2)
            continue;
        printf("  %-36s", method->builder);
        for (uint32_t i = 0; i < result->ray_count; i++) {
            bb_animate_interval intervals[BB_ANIMATE_INTERVALS_MAX];
            uint32_t count = bb_animate_faster(result, method, with, i, intervals);
            print_intervals(result->rays[i], intervals, count);
        }
        printf("\n");
    }
}

/* What the scene is like, which decides over methods more than its size. */
static void print_motion(const bb_animate_result *result)
{
    double moved = 0, by = 0;
    uint32_t count = 0;
    for (uint32_t f = 1; f < result->frame_count; f++)
        if (!isnan(result->states[f].moved)) {
            moved += result->states[f].moved;
            by += result->states[f].moved_by;
            count++;
        }
    if (count > 0)
        printf("  from frame to frame %.3g %% of the primitives move, by %.2g diagonals of the "
               "scene (means; of ways their median)\n",
               100 * moved / count, by / count);
    if (count + 1 < result->frame_count)
        printf("  in %u frames there are more or fewer primitives than before\n",
               result->frame_count - 1 - count);
}

void bb_animate_print(const bb_animate_result *result)
{
    uint64_t checked = 0, wrong = bb_animate_wrong(result);
    for (uint32_t m = 0; m < result->method_count; m++)
        checked += bb_animate_sum(result, &result->methods[m]).checked;
    printf("%s: frames %u to %u, view %s, %s, %u round%s\n", result->scene, result->states[0].frame,
           result->states[result->frame_count - 1].frame, result->view, result->intersector,
           result->rounds, result->rounds == 1 ? "" : "s");
    if (result->ignored > 0)
        printf("  ignored of the file: %u (points, lines, channels that move nothing known)\n",
               result->ignored);
    print_motion(result);
    print_methods(result);
    print_kernels(result);
    print_winners(result);
    print_faster(result);
    printf("\n  %llu answers judged, %llu wrong; %.1f s\n", (unsigned long long)checked,
           (unsigned long long)wrong, result->ms / 1e3);
}
