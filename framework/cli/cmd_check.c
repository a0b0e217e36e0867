/* bvhbench check: conformance of builders. Each tree is held to the promises of the common tree, must come out the same bit
 * for bit when built again (by the same object, and by a fresh one), and must be traced rightly: by every
 * kernel as by brute force, bit for bit. */
#include "framework/bench/conformance.h"
#include "framework/cli/choice.h"
#include "framework/device/device_private.h"
#include "framework/scene/scene.h"

#include <stdio.h>
#include <string.h>

static const bb_cli_option options[] = {
    {"builder", "B",
     "name:key=value,...; `all`; default: every builder, in the variants that it names", true},
    {"scene", "S", "default: the shipped scenes and small procedural ones", true},
    {"plugin", "FILE.so", "load a builder", true},
    {"device", "D", "index or part of the name of an OpenCL device; default: the first", false},
    {"form", "F", "of the parallel primitives: auto, cpu or gpu; default: auto", false},
    {"handover", "H", "between work-groups: auto, fence or levels; default: auto", false},
    {"kernels-from", "DIR", "read device code from here first", false},
    {"seed", "N", "of the rays; default: 1", false},
    {.name = NULL},
};

enum { SIDE = 128 }; /* of the ray sets */

/* Small scenes, each with something that builders trip over. */
static const char *const procedural_scenes[] = {
    "single",
    "cube",
    "interior:n=20000",
    "terrain:n=20000",
    "random:n=10000",
    "hairball:n=10000",
    "spheres:n=10000,state=initial",
    "spheres:n=10000,state=settled",
    "sphere-mesh",
    "sphere-mesh:x=148376,y=1234,z=-223423",
    "awkward:kind=outlier,n=2000",
    "awkward:kind=centroids,n=1000",
    "awkward:kind=flat",
    "awkward:kind=axis",
    "awkward:kind=duplicates",
    "awkward:kind=zeros,n=1000",
    "boards:length=1e5",
    "blinds:length=1e5",
    "corridor:length=1e5",
    "slivers:aspect=40",
    "scales:from=-8,to=8,n=1",
    "ground",
    "ladder",
};

static bb_status default_scenes(bb_names *names)
{
    for (const char *const *name = bb_shipped_scenes; *name != NULL; name++)
        BB_TRY(bb_names_add(names, *name));
    for (size_t i = 0; i < sizeof procedural_scenes / sizeof procedural_scenes[0]; i++)
        BB_TRY(bb_names_add(names, procedural_scenes[i]));
    return BB_OK;
}

typedef struct tally {
    uint32_t checked, failed;
} tally;

static bb_status check_scene(bb_device *device, const char *name, const bb_names *builders,
                             uint64_t seed, tally *tally)
{
    bb_scene *scene = NULL;
    bb_conformance *conformance = NULL;
    bb_status status = bb_scene_load(name, &scene);
    if (status == BB_OK)
        status = bb_conformance_create(device, scene, SIDE, seed, &conformance);
    if (status == BB_OK && scene->out_of_range > 0)
        printf("%-11s %-36s %u of %u primitives are too small beside the scene for floats\n",
               "note", name, scene->out_of_range, scene->prim_count);
    if (status == BB_OK && bb_conformance_left_out(conformance)[0] != '\0')
        printf("%-11s %-36s no rays %s\n", "note", name, bb_conformance_left_out(conformance));
    if (status == BB_OK && bb_conformance_brute_force(conformance) != BB_OK) {
        tally->failed++;
        printf("%-11s %-36s %-34s %s\n", "FAILED", name, "no tree, all primitives", bb_message());
    }
    for (size_t i = 0; i < builders->count && status == BB_OK; i++) {
        char note[512];
        bb_status found = bb_conformance_check(conformance, builders->items[i], note, sizeof note);
        const char *word = found == BB_OK            ? "ok"
                           : found == BB_UNSUPPORTED ? "unsupported"
                                                     : "FAILED";
        printf("%-11s %-36s %-34s %s\n", word, name, builders->items[i],
               found == BB_OK ? note : bb_message());
        fflush(stdout);
        tally->checked += found != BB_UNSUPPORTED;
        tally->failed += found != BB_OK && found != BB_UNSUPPORTED;
    }
    bb_conformance_destroy(conformance);
    bb_scene_free(scene);
    return status;
}

static bb_status run(const bb_cli *cli, int *exit_status)
{
    bb_names builders = {0}, scenes = {0};
    uint64_t seed = 1;
    uint32_t scenes_given;
    tally tally = {0};
    bb_device *device = NULL;
    bb_cli_values(cli, "scene", &scenes_given);
    bb_status status = bb_load_plugins(cli);
    if (status == BB_OK)
        status = bb_cli_u64(cli, "seed", 1, 0, UINT64_MAX, &seed);
    if (status == BB_OK)
        status = bb_choose_builders(cli, true, &builders);
    for (size_t i = 0; i < builders.count && status == BB_OK; i++)
        status = bb_instance_check(builders.items[i]);
    if (status == BB_OK)
        status = scenes_given > 0 ? bb_choose(cli, "scene", "", &scenes) : default_scenes(&scenes);
    if (status == BB_OK)
        status = bb_open_device(cli, &device);
    for (size_t i = 0; i < scenes.count && status == BB_OK; i++)
        status = check_scene(device, scenes.items[i], &builders, seed, &tally);
    if (status == BB_OK) {
        printf("%zu builders on %zu scenes, %u trees checked, %u checks failed\n", builders.count,
               scenes.count, tally.checked, tally.failed);
        if (tally.checked == 0)
            fprintf(stderr, "bvhbench: no builder takes any of the scenes: nothing was checked\n");
        *exit_status = tally.failed > 0 || tally.checked == 0 ? BB_EXIT_WRONG : BB_EXIT_OK;
    }
    bb_device_close(device);
    bb_names_free(&builders);
    bb_names_free(&scenes);
    return status;
}

extern const bb_command bb_command_check;
const bb_command bb_command_check = {
    .name = "check",
    .summary = "conformance of builders: valid trees, the same tree twice, right answers",
    .options = options,
    .run = run,
};
