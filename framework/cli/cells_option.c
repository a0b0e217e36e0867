#include "framework/cli/cells_option.h"

#include "framework/scene/camera.h"
#include "framework/workload/workload.h"
#include "traversal/traversal.h"

#include <stdlib.h>
#include <string.h>

void bb_entrants_request(const bb_entrants *entrants, bb_bench_request *request)
{
    request->scenes = entrants->scenes.items;
    request->scene_count = (uint32_t)entrants->scenes.count;
    request->builders = entrants->builders.items;
    request->builder_count = (uint32_t)entrants->builders.count;
    request->kernels = entrants->kernels.items;
    request->kernel_count = (uint32_t)entrants->kernels.count;
    request->workloads = entrants->workloads.items;
    request->workload_count = (uint32_t)entrants->workloads.count;
    request->intersectors = entrants->intersectors.items;
    request->intersector_count = (uint32_t)entrants->intersectors.count;
}

/* Checks what the grammar of keys does not: that the rays can be made, and from this view. */
static bb_status check_rays(const char *key, const bb_cell_parts *cell)
{
    const char *dots = strlen(key) > 80 ? "..." : "";
    bb_spec spec;
    if (cell->rays[0] == '\0')
        return BB_OK;
    if (cell->known_by_hash)
        return bb_fail(BB_INVALID,
                       "cell '%.80s%s': only a hash of its rays is known: they cannot be "
                       "generated again",
                       key, dots);
    if ((uint64_t)cell->width * cell->height > BB_PIXELS_MAX)
        return bb_fail(BB_INVALID, "cell '%.80s%s': at most %u pixels at once", key, dots,
                       (unsigned)BB_PIXELS_MAX);
    BB_TRY(bb_spec_parse(cell->rays, &spec));
    const bb_workload *workload = bb_workload_find(spec.name);
    if (workload == NULL)
        return BB_OK; /* bb_bench_check() reports it */
    if (workload->per_view != (cell->view[0] != '\0'))
        return bb_fail(BB_INVALID, "cell '%.80s%s': rays %s are made %s", key, dots, spec.name,
                       workload->per_view ? "from a view, and it names none"
                                          : "once for a scene, and it names a view");
    return BB_OK;
}

static bb_status add_once(bb_names *names, const char *text)
{
    if (text[0] == '\0')
        return BB_OK;
    for (size_t i = 0; i < names->count; i++)
        if (strcmp(names->items[i], text) == 0)
            return BB_OK;
    return bb_names_add_item(names, text);
}

/* Adds the cell's names to the group, without defaults, as tables show them. */
static bb_status add_names(bb_cells_group *group, const bb_cell_parts *cell)
{
    bb_cell_parts brief = *cell;
    bb_cell_short(&brief);
    bb_entrants *all = &group->entrants;
    BB_TRY(add_once(&all->scenes, brief.scene));
    BB_TRY(add_once(&all->builders, brief.builder));
    BB_TRY(add_once(&all->kernels, brief.kernel));
    BB_TRY(add_once(&all->workloads, brief.rays));
    return add_once(&all->intersectors, brief.intersector);
}

/* Compares size, number of rays and seed, which the cells of one comparison share. A build without
 * rays has no size. */
static int compare(const void *left, const void *right)
{
    const bb_cell_parts *a = left, *b = right;
    const uint64_t keys[][2] = {{a->seed, b->seed},
                                {a->width, b->width},
                                {a->height, b->height},
                                {a->max_rays, b->max_rays}};
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
        if (keys[i][0] != keys[i][1])
            return keys[i][0] < keys[i][1] ? -1 : 1;
    return 0;
}

static bb_status form_groups(bb_cells *cells, uint32_t count)
{
    qsort(cells->cells, count, sizeof *cells->cells, compare);
    for (uint32_t i = 0; i < count; i++) {
        if (i == 0 || compare(&cells->cells[i - 1], &cells->cells[i]) != 0)
            cells->groups[cells->group_count++].cells = &cells->cells[i];
        bb_cells_group *group = &cells->groups[cells->group_count - 1];
        group->count++;
        BB_TRY(add_names(group, &cells->cells[i]));
    }
    return BB_OK;
}

bb_status bb_cells_read(const bb_names *keys, bb_cells *cells)
{
    const uint32_t count = (uint32_t)keys->count;
    if (count == 0)
        return BB_OK;
    cells->cells = calloc(count, sizeof *cells->cells);
    cells->groups = calloc(count, sizeof *cells->groups);
    if (cells->cells == NULL || cells->groups == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    for (uint32_t i = 0; i < count; i++) {
        BB_TRY(bb_cell_key_parse(keys->items[i], &cells->cells[i]));
        bb_cell_canonical(&cells->cells[i]);
        BB_TRY(bb_check_scene(cells->cells[i].scene));
        BB_TRY(check_rays(keys->items[i], &cells->cells[i]));
    }
    BB_TRY(form_groups(cells, count));
    for (uint32_t i = 0; i < cells->group_count; i++) {
        bb_bench_request request = {0};
        bb_cells_request(&cells->groups[i], &request);
        BB_TRY(bb_bench_check(&request));
    }
    return BB_OK;
}

void bb_cells_request(const bb_cells_group *group, bb_bench_request *request)
{
    const bb_cell_parts *first = &group->cells[0];
    request->cells = group->cells;
    request->cell_count = group->count;
    bb_entrants_request(&group->entrants, request);
    request->native = false;
    request->seed = first->seed;
    if (first->width == 0)
        return; /* only builds: there are no rays that a size would apply to */
    request->width = first->width;
    request->height = first->height;
    request->max_rays = first->max_rays;
}

void bb_cells_free(bb_cells *cells)
{
    for (uint32_t i = 0; i < cells->group_count; i++) {
        bb_entrants *all = &cells->groups[i].entrants;
        bb_names *const names[] = {&all->scenes, &all->builders, &all->kernels, &all->workloads,
                                   &all->intersectors};
        for (size_t k = 0; k < sizeof names / sizeof names[0]; k++)
            bb_names_free(names[k]);
    }
    free(cells->groups);
    free(cells->cells);
}
