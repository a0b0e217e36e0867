#include "framework/cli/contest_options.h"

#include "framework/base/clock.h"
#include "framework/base/interrupt.h"
#include "framework/bench/tet_search.h"
#include "framework/builder/pipeline.h"
#include "framework/builder/registry.h"
#include "framework/cli/inputs.h"
#include "framework/cli/names.h"
#include "framework/cli/out_option.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const bb_cli_option bb_contest_options[] = {
    {"json", NULL, "print JSON", BB_INTO(bb_contest_choice, json)},
    BB_GROUP(bb_device_options, bb_contest_choice, device),
    {.name = NULL},
};

bb_status bb_check_searches(const bb_names *searches)
{
    for (size_t i = 0; i < searches->count; i++) {
        bb_spec spec;
        BB_TRY(bb_tet_search_parse(searches->items[i], &spec));
        for (size_t k = 0; k < i; k++)
            if (strcmp(searches->items[k], searches->items[i]) == 0)
                return bb_fail(BB_INVALID, "--search has %s twice", searches->items[i]);
    }
    return BB_OK;
}

static const char *declared(const bb_builder *builder, bb_contest_kind kind)
{
    return bb_builder_variants(builder, kind == BB_OF_VOLUMES ? BB_ROLE_VOLUMES : BB_ROLE_MESHES);
}

/* The usual builder is first: of meshes, others are compared with it. Those that take long are
 * last. */
static bb_status add_declared(bb_names *names, bb_contest_kind kind)
{
    const bb_builder *usual = bb_usual_builder(BB_ALL_KINDS);
    if (usual != NULL && declared(usual, kind) != NULL)
        BB_TRY(bb_names_add(names, declared(usual, kind)));
    for (uint32_t i = 0; i < bb_builder_count(); i++)
        if (bb_builder_at(i) != usual && declared(bb_builder_at(i), kind) != NULL)
            BB_TRY(bb_names_add(names, declared(bb_builder_at(i), kind)));
    return kind == BB_OF_MESHES ? bb_names_add_role(names, BB_ROLE_MESHES_LONG) : BB_OK;
}

bb_status bb_choose_tree_builders(bb_names *builders, bb_contest_kind kind)
{
    return builders->count > 0 ? bb_choose_builders(builders, true) : add_declared(builders, kind);
}

static void print_declared(FILE *out, bb_contest_kind kind, const char *what)
{
    bb_names names = {0};
    if (add_declared(&names, kind) == BB_OK)
        for (size_t i = 0; i < names.count; i++)
            fprintf(out, "%s%s", i == 0 ? what : ", ", names.items[i]);
    fputs(names.count > 0 ? "\n" : "", out);
    bb_names_free(&names);
}

void bb_print_volume_builders(FILE *out)
{
    print_declared(out, BB_OF_VOLUMES, "\nbuilders by default: of volumes ");
    print_declared(out, BB_OF_MESHES, "                     of meshes ");
}

void bb_print_mesh_builders(FILE *out)
{
    print_declared(out, BB_OF_MESHES, "\nbuilders by default: ");
}

double bb_contest_ends(const bb_contest_choice *choice, size_t left)
{
    const double now = bb_wall_ms();
    return choice->ends_ms > 0 ? now + fmax(0, choice->ends_ms - now) / (double)left : 0;
}

bb_status bb_contest_begin(bb_contest_choice *choice, char *const *scenes, size_t count)
{
    BB_TRY(bb_time_option(choice->time, &choice->ends_ms));
    BB_TRY(bb_choose_simulations(&choice->metrics, choice->simts, &choice->simt_count));
    BB_TRY(bb_load_plugins(&choice->device.plugins));
    for (size_t i = 0; i < count; i++)
        BB_TRY(bb_check_scene(scenes[i]));
    return choice->out != NULL ? bb_out_folder(choice->out) : BB_OK;
}

bb_status bb_contest_end(bb_status status, bool wrong, int *exit_status)
{
    if (status == BB_OK && wrong)
        *exit_status = BB_EXIT_WRONG;
    if (!bb_interrupted())
        return status;
    fprintf(stderr, "bvhbench: interrupted: %s\n",
            status == BB_OK ? "the results are those of what was measured" : bb_message());
    *exit_status = BB_EXIT_INTERRUPTED;
    return BB_OK;
}
