/* Prints the bytes that a build moves by the model of framework/device/tally.h:
 * build_tally SCENE BUILDER. Under oclgrind, moved.cpp counts what it really moves. */
#include "framework/device/device_private.h"
#include "framework/simulate/build.h"

#include <inttypes.h>
#include <stdio.h>

static bb_status tally(const char *scene_text, const char *builder)
{
    bb_device *device;
    bb_scene *scene;
    bb_build_moves moves;
    uint64_t bytes = 0;
    BB_TRY(bb_device_open(NULL, BB_FORM_GPU, NULL, &device));
    BB_TRY(bb_scene_load(scene_text, &scene));
    BB_TRY(bb_scene_upload(scene, device));
    BB_TRY(bb_scene_make_boxes(scene));
    BB_TRY(bb_build_tally(device, builder, scene, 1, &moves));
    for (uint32_t i = 0; i < moves.tally.move_count; i++)
        bytes += moves.tally.moves[i].bytes;
    printf("%" PRIu64 " %" PRIu64 "\n", bytes, moves.launches);
    bb_build_moves_release(&moves);
    bb_scene_free(scene);
    bb_device_close(device);
    return BB_OK;
}

int main(int argc, char **argv)
{
    if (argc == 3 && tally(argv[1], argv[2]) == BB_OK)
        return 0;
    fprintf(stderr, "build_tally SCENE BUILDER: %s\n", bb_message());
    return 1;
}
