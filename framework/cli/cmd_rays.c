/* bvhbench rays: a scene and a ray set in a file, for tracers that are no plug-ins. */
#include "framework/base/file.h"
#include "framework/base/limits.h"
#include "framework/cli/choice.h"
#include "framework/cli/out_option.h"
#include "framework/judge/oracle.h"
#include "framework/scene/prim.h"
#include "framework/workload/exchange_file.h"
#include "framework/workload/workload.h"

#include <stdio.h>

extern const char bb_build_version[], bb_build_revision[];

typedef struct job {
    const char *scene_name, *rays_text, *out, *view;
    bb_spec spec;
    const bb_workload *workload;
    bb_rays_request request;
    bb_scene *scene;
    bb_oracle *oracle;
    bb_rays *rays;
} job;

static const bb_cli_option options[] = {
    {"scene", "S", "file, shipped or procedural scene", BB_INTO(job, scene_name), .needed = true},
    {"rays", "R", "workload and its parameters: see `bvhbench list rays`", BB_INTO(job, rays_text),
     .needed = true},
    {"out", "FILE", "file to write", BB_INTO(job, out), .needed = true},
    {"view", "V", "camera for primary rays: a view of the scene; default: the first",
     BB_INTO(job, view)},
    {"size", "WxH", "image size for primary rays", BB_INTO_SIZE(job, request.width),
     .fallback = "512x512"},
    {"max-rays", "N", "most rays of a workload that samples", BB_INTO(job, request.max_rays),
     .low = 1, .high = 1u << 30, .fallback = "1048576"},
    BB_SEED_OPTION(job, request.seed),
    {.name = NULL},
};

static bb_status make_rays(job *j)
{
    BB_TRY(bb_check_scene(j->scene_name));
    BB_TRY(bb_workload_parse(j->rays_text, &j->spec, &j->workload));
    if (!j->workload->per_view && j->view != NULL)
        return bb_fail(BB_INVALID, "rays %s are made from all views at once: drop --view",
                       j->workload->name);
    BB_TRY(bb_out_file(j->out, "rays file"));
    j->request.spec = &j->spec;
    BB_TRY(bb_scene_load(j->scene_name, &j->scene));
    if (j->workload->per_view)
        BB_TRY(bb_choose_view(j->scene, j->view, &j->request.view));
    BB_TRY(bb_oracle_create(j->scene, bb_core_count(), &j->oracle));
    return bb_rays_make(j->scene, j->oracle, &j->request, &j->rays);
}

static bb_status write_rays(const job *j, const char *command)
{
    char generator[sizeof((bb_rays_header *)0)->generator];
    snprintf(generator, sizeof generator, "bvhbench %s (%s): %s", bb_build_version,
             bb_build_revision, command);
    BB_TRY(bb_exchange_write_rays(j->out, j->scene, j->rays, generator));
    printf("%s: %u rays, %s%s%s, %s hit;", j->out, j->rays->count, j->rays->name,
           j->rays->view[0] != '\0' ? " from " : "", j->rays->view, j->rays->query->name);
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        if (kind <= BB_SPHERE || j->scene->prims[kind].count > 0)
            printf("%s %u %s", kind > 0 ? "," : "", j->scene->prims[kind].count,
                   bb_prim_kinds[kind]->plural);
    printf("; rays %016llx, scene %016llx\n", (unsigned long long)j->rays->hash,
           (unsigned long long)j->scene->hash);
    return BB_OK;
}

static bb_status run(const bb_cli *cli, void *values, int *exit_status)
{
    (void)exit_status;
    BB_TRY(make_rays(values));
    return write_rays(values, cli->command_line);
}

static void release(void *values)
{
    job *j = values;
    bb_rays_free(j->rays);
    bb_oracle_destroy(j->oracle);
    bb_scene_free(j->scene);
}

extern const bb_command bb_command_rays;
const bb_command bb_command_rays = {
    .name = "rays",
    .summary = "write a scene and a ray set to a file, for external tracers",
    .details =
        "With the same scene, size, max-rays and seed, these are the rays that `run` traces.\n"
        "framework/workload/exchange.h has the format of this file and of the hits file that\n"
        "`bvhbench judge` takes; examples/outside-tracer is a complete tracer.",
    .options = options,
    .bytes = sizeof(job),
    .run = run,
    .release = release,
};
