/* glTF as JSON whose first animation is played: in three frames, forth and back again. */
#include "tests/fuzz/scene.h"

enum { CLIP_FRAMES = 3 };

/* A frame that was there is there again, bit for bit. */
static void fuzz_frame(bb_scene *scene, uint32_t frame, uint64_t hashes[CLIP_FRAMES])
{
    bb_status status = bb_scene_set_frame(scene, frame, NULL);
    if (status != BB_OK) {
        fuzz_refused(status);
        FUZZ_CHECK(hashes[frame] == 0);
        return;
    }
    fuzz_check_scene(scene);
    FUZZ_CHECK(hashes[frame] == 0 || hashes[frame] == scene->hash);
    hashes[frame] = scene->hash;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char text[256];
    bb_scene *scene = NULL;
    uint64_t hashes[CLIP_FRAMES] = {0};
    snprintf(text, sizeof text, "%s:clip=0,frames=3", fuzz_file("clip.gltf", data, size));
    bb_status status = bb_scene_load(text, &scene);
    if (status != BB_OK) {
        fuzz_refused(status);
        FUZZ_CHECK(scene == NULL);
        return 0;
    }
    static const uint32_t order[] = {0, 1, 2, 1, 0};
    hashes[0] = scene->hash;
    for (size_t i = 0; i < sizeof order / sizeof order[0]; i++)
        fuzz_frame(scene, order[i], hashes);
    bb_scene_free(scene);
    return 0;
}
