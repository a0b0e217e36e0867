/* Which cells are measured: makes the keys of cells and compares them with the requested ones. */
#include "framework/bench/bench_private.h"

#include <stdio.h>
#include <string.h>

bb_cell_parts bb_bench_cell(const bb_bench *bench)
{
    const bb_bench_request *request = bench->request;
    bb_cell_parts cell = {.width = request->width,
                          .height = request->height,
                          .max_rays = request->max_rays,
                          .seed = request->seed};
    snprintf(cell.scene, sizeof cell.scene, "%s", bench->scene_text);
    return cell;
}

void bb_bench_key(const bb_cell_parts *cell, char key[BB_CELL_KEY])
{
    bb_cell_parts canonical = *cell;
    bb_cell_canonical(&canonical);
    if (bb_cell_key_format(&canonical, key) != BB_OK)
        key[0] = '\0';
}

static bool fits(const char *part, const char *wanted)
{
    return part[0] == '\0' || strcmp(part, wanted) == 0;
}

/* Returns NULL, which stands for any, for "". */
static const char *or_any(const char *part)
{
    return part[0] != '\0' ? part : NULL;
}

bool bb_bench_wants(const bb_bench *bench, const bb_cell_parts *parts)
{
    const bb_bench_request *request = bench->request;
    if (request->takes != NULL &&
        !request->takes(request->user, or_any(parts->builder), or_any(parts->kernel),
                        or_any(parts->intersector)))
        return false;
    if (request->cell_count == 0)
        return true;
    bb_cell_parts cell = *parts;
    bb_cell_canonical(&cell);
    for (uint32_t i = 0; i < request->cell_count; i++) {
        const bb_cell_parts *wanted = &request->cells[i];
        if (fits(cell.scene, wanted->scene) && fits(cell.builder, wanted->builder) &&
            fits(cell.rays, wanted->rays) && fits(cell.kernel, wanted->kernel) &&
            fits(cell.intersector, wanted->intersector) &&
            (cell.rays[0] == '\0' || strcmp(cell.view, wanted->view) == 0))
            return true;
    }
    return false;
}

bb_status bb_bench_check_views(const bb_bench *bench, const bb_scene *scene, const char *text)
{
    bb_cell_parts here = {.seed = 0};
    snprintf(here.scene, sizeof here.scene, "%s", text);
    bb_cell_canonical(&here);
    for (uint32_t i = 0; i < bench->request->cell_count; i++) {
        const char *view = bench->request->cells[i].view;
        uint32_t v = 0;
        if (view[0] == '\0' || strcmp(here.scene, bench->request->cells[i].scene) != 0)
            continue;
        while (v < scene->view_count && strcmp(scene->views[v].name, view) != 0)
            v++;
        if (v == scene->view_count)
            return bb_fail(BB_INVALID, "cell: %s has no view '%s': its first is '%s'", text, view,
                           scene->views[0].name);
    }
    return BB_OK;
}
