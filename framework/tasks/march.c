#include "framework/tasks/march.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES_MAX = 1 << 22 };
/* Variants of the march without a tree; the last is compiled when it is asked for. */
enum { PLAIN, COUNTING, RECORDING, VARIANTS };

struct bb_marcher {
    const bb_scene *scene;
    bb_device *device;
    char ordered[64], unordered[64]; /* -D for kernels */
    bb_march_args args;
    bb_buffer table;
    cl_program programs[VARIANTS];
    cl_kernel kernels[VARIANTS];
    bb_arg more[3];
};

static bool same(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(bb_light)) == 0;
}

static void say(const void *result, char *text, size_t capacity)
{
    const bb_light *light = result;
    snprintf(text, capacity, "light (%g, %g, %g), %g left", (double)light->rgb[0],
             (double)light->rgb[1], (double)light->rgb[2], (double)light->left);
}

const bb_query bb_query_march = {
    .name = "march",
    .asks = "light",
    .define = "BB_QUERY_MARCH",
    .way = BB_ALONG_RAYS,
    .kinds = BB_AABBS,
    .result_bytes = sizeof(bb_light),
    .is_recorded = true,
    .same = same,
    .say = say,
};

void bb_marcher_destroy(bb_marcher *marcher)
{
    if (marcher == NULL)
        return;
    bb_buffer_release(&marcher->table);
    for (int i = 0; i < VARIANTS; i++) {
        bb_kernel_release(marcher->kernels[i]);
        bb_program_release(marcher->programs[i]);
    }
    free(marcher);
}

static bb_status compile(bb_marcher *marcher, int variant)
{
    char defines[192];
    if (marcher->kernels[variant] != NULL)
        return BB_OK;
    snprintf(defines, sizeof defines, "%s -DBB_KINDS=%u -DBB_COUNTING=%d%s%s", marcher->unordered,
             (unsigned)BB_AABBS, variant != PLAIN, variant == RECORDING ? " -DBB_RECORDING=1" : "",
             bb_device_divides_exactly(marcher->device) ? " -cl-fp32-correctly-rounded-divide-sqrt"
                                                        : "");
    BB_TRY(bb_program_build(marcher->device, bb_source_find("march_all.cl"), defines,
                            &marcher->programs[variant]));
    return bb_kernel_get(marcher->programs[variant], "march_all", &marcher->kernels[variant]);
}

static void set_defines(const bb_volume *volume, int ordered, char *text, size_t capacity)
{
    snprintf(text, capacity, "-DBB_VOXEL=%s -DBB_SIDE=%u%s",
             volume->bytes == 1 ? "uchar" : "ushort", volume->grid.side,
             ordered ? " -DBB_MARCH_ORDERED=1" : " -DBB_MARCH_ORDERED=0");
}

bb_status bb_marcher_create(const bb_scene *scene, bb_account *account, bb_marcher **out)
{
    const bb_volume *volume = scene->volume;
    if (volume == NULL)
        return bb_fail(BB_INVALID, "%s: has no volume to march through", scene->name);
    bb_marcher *marcher = calloc(1, sizeof *marcher);
    if (marcher == NULL)
        return bb_fail(BB_REFUSED, "no memory for a march");
    marcher->scene = scene;
    marcher->device = scene->on_device.device;
    set_defines(volume, 1, marcher->ordered, sizeof marcher->ordered);
    set_defines(volume, 0, marcher->unordered, sizeof marcher->unordered);
    bb_status status =
        bb_buffer_reserve(marcher->device, account, BB_TRANSFER_STEPS * sizeof(bb_transfer_entry),
                          "table of a transfer function", &marcher->table);
    for (int i = PLAIN; i <= COUNTING && status == BB_OK; i++)
        status = compile(marcher, i);
    if (status != BB_OK) {
        bb_marcher_destroy(marcher);
        return status;
    }
    marcher->more[0] = BB_MEM(scene->on_device.bricks);
    marcher->more[1] = BB_MEM(marcher->table);
    marcher->more[2] = BB_VALUE(marcher->args);
    *out = marcher;
    return BB_OK;
}

bb_status bb_march_check_settings(const bb_march_settings *settings)
{
    if (!(settings->step > 0) || !isfinite(settings->step))
        return bb_fail(BB_INVALID, "samples %g apart: it must be above 0", (double)settings->step);
    if (!(settings->cutoff >= 0 && settings->cutoff <= 1))
        return bb_fail(BB_INVALID, "a march that ends where %g is left: it must be 0 to 1",
                       (double)settings->cutoff);
    return BB_OK;
}

bb_status bb_marcher_set(bb_marcher *marcher, const bb_march_settings *settings)
{
    const bb_volume *volume = marcher->scene->volume;
    bb_transfer_entry table[BB_TRANSFER_STEPS];
    BB_TRY(bb_march_check_settings(settings));
    marcher->args = (bb_march_args){volume->grid, settings->step, settings->cutoff};
    bb_transfer_table(&volume->transfer, bb_volume_voxel(volume), table);
    return bb_buffer_write(&marcher->table, 0, sizeof table, table);
}

bb_status bb_march_check(const bb_scene *scene, const bb_rays *rays, float step)
{
    for (uint32_t i = 0; i < rays->count; i++) {
        double far = 0;
        for (int k = 0; k < 3; k++) {
            double o = rays->rays[i].o[k];
            double away = fmax(fabs(o - scene->bounds.lo[k]), fabs(o - scene->bounds.hi[k]));
            far += away * away;
        }
        if (sqrt(far) / step >= SAMPLES_MAX)
            return bb_fail(BB_REFUSED,
                           "%s: ray %u of %s has up to %.0f samples to the end of the volume, %d "
                           "can be told apart: take a longer step",
                           scene->name, i, rays->name, sqrt(far) / step, SAMPLES_MAX);
    }
    return BB_OK;
}

void bb_march_traverser_request(const bb_marcher *marcher, bb_traverser_request *request)
{
    request->query = &bb_query_march;
    request->defines = request->kernel->ordered ? marcher->ordered : marcher->unordered;
}

void bb_march_pass(const bb_marcher *marcher, bb_pass *pass)
{
    pass->query = &bb_query_march;
    pass->more = marcher->more;
    pass->more_count = 3;
}

bb_status bb_march_all(bb_marcher *marcher, const bb_buffer *rays, uint32_t count,
                       bb_buffer *lights, bb_buffer *counts, const bb_recording *recording)
{
    const int variant = recording != NULL ? RECORDING : counts != NULL ? COUNTING : PLAIN;
    bb_arg args[11];
    uint32_t n = 0;
    BB_TRY(compile(marcher, variant));
    args[n++] = BB_VALUE(marcher->scene->scale);
    args[n++] = BB_MEM(*rays);
    args[n++] = BB_VALUE(count);
    args[n++] = BB_MEM(*lights);
    if (counts != NULL)
        args[n++] = BB_MEM(*counts);
    if (recording != NULL) {
        args[n++] = BB_MEM(recording->ends);
        args[n++] = BB_MEM(recording->steps);
        args[n++] = BB_MEM(recording->counts);
    }
    for (int i = 0; i < 3; i++)
        args[n++] = marcher->more[i];
    return bb_launch_args(marcher->device, marcher->kernels[variant], count, BB_MARCH_GROUP, args,
                          n);
}
