/* Loads and samples the scene. */
#include "framework/advise/ground.h"

#include "framework/device/device_private.h"

/* Enough that builds take longer than their launches, and few enough that the slowest builders take
 * less than a second. */
static const uint32_t sample_prims = 1 << 16;

static bb_status prepare(bb_device *device, bb_ground *ground)
{
    BB_TRY(bb_scene_upload(ground->scene, device));
    return bb_oracle_create(ground->scene, bb_host_threads(device), &ground->oracle);
}

bb_status bb_ground_load(bb_device *device, const char *scene, bb_ground *whole)
{
    *whole = (bb_ground){.factor = 1};
    BB_TRY(bb_scene_load(scene, &whole->scene));
    return prepare(device, whole);
}

bb_status bb_ground_sample(bb_device *device, const bb_ground *whole, bb_ground *sample)
{
    *sample = *whole;
    if (whole->scene->prim_count <= sample_prims || whole->scene->volume != NULL)
        return BB_OK;
    *sample = (bb_ground){.scene = NULL};
    BB_TRY(bb_scene_sample(whole->scene, sample_prims, &sample->scene));
    sample->factor = (double)whole->scene->prim_count / sample->scene->prim_count;
    return prepare(device, sample);
}

void bb_ground_free(bb_ground *ground, const bb_ground *whole)
{
    if (whole == NULL || ground->scene != whole->scene) {
        bb_oracle_destroy(ground->oracle);
        bb_scene_free(ground->scene);
    }
    ground->oracle = NULL;
    ground->scene = NULL;
}
