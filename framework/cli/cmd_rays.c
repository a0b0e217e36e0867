/* bvhbench rays: a scene and a ray set in a file, for tracers that are no plug-ins. */
#include "framework/base/file.h"
#include "framework/base/threads.h"
#include "framework/cli/choice.h"
#include "framework/cli/out_option.h"
#include "framework/exchange/exchange_file.h"
#include "framework/judge/oracle.h"
#include "framework/scene/prim.h"
#include "framework/workload/workload.h"

#include <stdio.h>
#include <stdlib.h>

extern const char bb_build_version[], bb_build_revision[];

static const bb_cli_option options[] = {
    {"scene", "S", "file, shipped or procedural scene", false},
    {"rays", "R", "workload and its parameters: see `bvhbench list rays`", false},
    {"out", "FILE", "file to write", false},
    {"view", "V", "camera for primary rays: a view of the scene; default: the first", false},
    {"size", "WxH", "image size for primary rays; default: 512x512", false},
    {"max-rays", "N", "most rays of a workload that samples; default: 1048576", false},
    {"seed", "N", "random seed; default: 1", false},
    {.name = NULL},
};

typedef struct job {
    bb_spec spec;
    const bb_workload *workload;
    bb_rays_request request;
    bb_scene *scene;
    bb_oracle *oracle;
    bb_rays *rays;
} job;

static bb_status read_options(const bb_cli *cli, job *j)
{
    const char *rays = bb_cli_value(cli, "rays");
    if (bb_cli_value(cli, "scene") == NULL || rays == NULL || bb_cli_value(cli, "out") == NULL)
        return bb_fail(BB_INVALID,
                       "rays needs --scene, --rays and --out: see `bvhbench rays --help`");
    BB_TRY(bb_check_scene(bb_cli_value(cli, "scene")));
    BB_TRY(bb_workload_parse(rays, &j->spec, &j->workload));
    if (!j->workload->per_view && bb_cli_value(cli, "view") != NULL)
        return bb_fail(BB_INVALID, "rays %s are made from all views at once: drop --view",
                       j->workload->name);
    BB_TRY(bb_out_file(bb_cli_value(cli, "out"), "rays file"));
    uint64_t max_rays;
    j->request = (bb_rays_request){.spec = &j->spec, .width = 512, .height = 512};
    BB_TRY(bb_cli_size(cli, "size", &j->request.width, &j->request.height));
    BB_TRY(bb_cli_u64(cli, "max-rays", 1 << 20, 1, 1u << 30, &max_rays));
    BB_TRY(bb_cli_u64(cli, "seed", 1, 0, UINT64_MAX, &j->request.seed));
    j->request.max_rays = (uint32_t)max_rays;
    return BB_OK;
}

static bb_status make_rays(const bb_cli *cli, job *j)
{
    BB_TRY(bb_scene_load(bb_cli_value(cli, "scene"), &j->scene));
    if (j->workload->per_view)
        BB_TRY(bb_choose_view(j->scene, bb_cli_value(cli, "view"), &j->request.view));
    BB_TRY(bb_oracle_create(j->scene, bb_core_count(), &j->oracle));
    return bb_rays_make(j->scene, j->oracle, &j->request, &j->rays);
}

static bb_status write_rays(const bb_cli *cli, const job *j)
{
    char *command = bb_cli_command_line(cli);
    char generator[sizeof((bb_rays_header *)0)->generator];
    snprintf(generator, sizeof generator, "bvhbench %s (%s): %s", bb_build_version,
             bb_build_revision, command != NULL ? command : "");
    free(command);
    const char *out = bb_cli_value(cli, "out");
    BB_TRY(bb_exchange_write_rays(out, j->scene, j->rays, generator));
    printf("%s: %u rays, %s%s%s, %s hit;", out, j->rays->count, j->rays->name,
           j->rays->view[0] != '\0' ? " from " : "", j->rays->view, j->rays->query->name);
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        if (kind <= BB_SPHERE || j->scene->prims[kind].count > 0)
            printf("%s %u %s", kind > 0 ? "," : "", j->scene->prims[kind].count,
                   bb_prim_kinds[kind]->plural);
    printf("; rays %016llx, scene %016llx\n", (unsigned long long)j->rays->hash,
           (unsigned long long)j->scene->hash);
    return BB_OK;
}

static bb_status run(const bb_cli *cli, int *exit_status)
{
    (void)exit_status;
    job j = {0};
    bb_status status = read_options(cli, &j);
    if (status == BB_OK)
        status = make_rays(cli, &j);
    if (status == BB_OK)
        status = write_rays(cli, &j);
    bb_rays_free(j.rays);
    bb_oracle_destroy(j.oracle);
    bb_scene_free(j.scene);
    return status;
}

extern const bb_command bb_command_rays;
const bb_command bb_command_rays = {
    .name = "rays",
    .summary = "write a scene and a ray set to a file, for external tracers",
    .details =
        "With the same scene, size, max-rays and seed, these are the rays that `run` traces.\n"
        "framework/exchange/exchange.h has the format of this file and of the hits file that\n"
        "`bvhbench judge` takes; examples/outside-tracer is a complete tracer.",
    .options = options,
    .run = run,
};
