/* bvhbench check: conformance of builders. Each tree is held to the promises of the common tree, must come out the same bit
 * for bit when built again (by the same object, and by a fresh one), and must be traced rightly. */
#include "framework/builder.h"
#include "framework/cli.h"
#include "framework/conformance.h"
#include "framework/device_option.h"
#include "framework/scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const bb_cli_option options[] = {
    {"builder", "B", "name:key=value,...; default: those that each builder names, and all others", true},
    {"scene", "S", "default: the shipped scenes and small procedural ones", true},
    {"plugin", "FILE.so", "load a builder", true},
    {"device", "D", "index or part of the name of an OpenCL device; default: the first", false},
    {"form", "F", "of the parallel primitives: auto, cpu or gpu; default: auto", false},
    {"kernels-from", "DIR", "read device code from here first", false},
    {"seed", "N", "of the rays; default: 1", false},
    {.name = NULL},
};

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
};

enum { NAMES_MAX = 128 };

static bb_status default_builders(char **names, size_t *count)
{
    for (uint32_t i = 0; i < bb_builder_count(); i++) {
        const bb_builder *builder = bb_builder_at(i);
        bool own = builder->compared != NULL && builder->compared[0] != '\0';
        BB_TRY(bb_spec_list(own ? builder->compared : builder->name, names, NAMES_MAX, count));
    }
    return BB_OK;
}

static bb_status default_scenes(char **names, size_t *count)
{
    for (const char *const *name = bb_shipped_scenes; *name != NULL; name++)
        names[(*count)++] = strdup(*name);
    for (size_t i = 0; i < sizeof procedural_scenes / sizeof procedural_scenes[0]; i++)
        names[(*count)++] = strdup(procedural_scenes[i]);
    return BB_OK;
}

static bb_status copy_values(const bb_cli *cli, const char *option, char **names, size_t *count)
{
    uint32_t given;
    char *const *values = bb_cli_values(cli, option, &given);
    if (given > NAMES_MAX)
        return bb_fail(BB_INVALID, "--%s: at most %d at once", option, NAMES_MAX);
    for (uint32_t i = 0; i < given; i++)
        names[(*count)++] = strdup(values[i]);
    return BB_OK;
}

static bb_status check_scene(bb_device *device, const char *name, char *const *builders,
                             size_t builder_count, uint64_t seed, uint32_t *failures)
{
    bb_scene *scene = NULL;
    bb_conformance *conformance = NULL;
    bb_status status = bb_scene_load(name, &scene);
    if (status == BB_OK)
        status = bb_conformance_create(device, scene, seed, &conformance);
    for (size_t i = 0; i < builder_count && status == BB_OK; i++) {
        char note[256];
        bb_status found = bb_conformance_check(conformance, builders[i], note, sizeof note);
        const char *word = found == BB_OK ? "ok" : found == BB_UNSUPPORTED ? "unsupported" : "FAILED";
        printf("%-11s %-36s %-34s %s\n", word, name, builders[i],
               found == BB_OK ? note : bb_message());
        fflush(stdout);
        *failures += found != BB_OK && found != BB_UNSUPPORTED;
    }
    bb_conformance_destroy(conformance);
    bb_scene_free(scene);
    return status;
}

static bb_status run(const bb_cli *cli, int *exit_status)
{
    char *builders[NAMES_MAX], *scenes[NAMES_MAX];
    size_t builder_count = 0, scene_count = 0;
    uint64_t seed = 1;
    uint32_t failures = 0;
    bb_device *device = NULL;
    bb_status status = bb_load_plugins(cli);
    if (status == BB_OK)
        status = bb_cli_u64(cli, "seed", 1, 0, UINT64_MAX, &seed);
    if (status == BB_OK)
        status = copy_values(cli, "builder", builders, &builder_count);
    if (status == BB_OK && builder_count == 0)
        status = default_builders(builders, &builder_count);
    for (size_t i = 0; i < builder_count && status == BB_OK; i++)
        status = bb_instance_check(builders[i]);
    if (status == BB_OK)
        status = copy_values(cli, "scene", scenes, &scene_count);
    if (status == BB_OK && scene_count == 0)
        status = default_scenes(scenes, &scene_count);
    if (status == BB_OK)
        status = bb_open_device(cli, &device);
    for (size_t i = 0; i < scene_count && status == BB_OK; i++)
        status = check_scene(device, scenes[i], builders, builder_count, seed, &failures);
    if (status == BB_OK) {
        printf("%zu builders on %zu scenes, %u failed\n", builder_count, scene_count, failures);
        *exit_status = failures > 0 ? BB_EXIT_WRONG : BB_EXIT_OK;
    }
    bb_device_close(device);
    for (size_t i = 0; i < builder_count; i++)
        free(builders[i]);
    for (size_t i = 0; i < scene_count; i++)
        free(scenes[i]);
    return status;
}

const bb_command bb_command_check = {
    .name = "check",
    .summary = "conformance of builders: valid trees, the same tree twice, right answers",
    .options = options,
    .run = run,
};
