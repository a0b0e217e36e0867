#include "builders/common/view_order.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Reads X/Y/Z: three finite numbers and nothing else. */
static bool read_direction(const char *text, double out[3])
{
    for (int axis = 0; axis < 3; axis++) {
        char *end;
        out[axis] = strtod(text, &end);
        if (end == text || !isfinite(out[axis]) || *end != (axis < 2 ? '/' : '\0'))
            return false;
        text = end + 1;
    }
    return true;
}

/* Finds a view by name, else by number; NULL if the scene has no such view. */
static const bb_view *find_view(const bb_scene *scene, const char *text)
{
    for (uint32_t i = 0; i < scene->view_count; i++)
        if (strcmp(scene->views[i].name, text) == 0)
            return &scene->views[i];
    if (*text == '\0' || strspn(text, "0123456789") != strlen(text))
        return NULL;
    unsigned long number = strtoul(text, NULL, 10);
    return number < scene->view_count ? &scene->views[number] : NULL;
}

static bb_status fail_unknown(const bb_scene *scene, const char *text, const char *what)
{
    char names[512] = "";
    size_t used = 0;
    for (uint32_t i = 0; i < scene->view_count && used < sizeof names; i++)
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", i > 0 ? ", " : "",
                                 scene->views[i].name);
    return bb_fail(BB_INVALID,
                   "%s: '%s' is no view of scene %s (%s), nor none, nor a direction X/Y/Z", what,
                   text, scene->name, scene->view_count > 0 ? names : "it has none");
}

bb_status bb_view_order(const bb_scene *scene, const char *text, const char *what,
                        double direction[3])
{
    const double unordered[3] = {0, 0, 0};
    memcpy(direction, unordered, sizeof unordered);
    if (strcmp(text, "none") == 0)
        return BB_OK;
    const bb_view *view = find_view(scene, text);
    if (view == NULL && !read_direction(text, direction))
        return fail_unknown(scene, text, what);
    for (int axis = 0; axis < 3 && view != NULL; axis++)
        direction[axis] = view->target[axis] - view->eye[axis];
    double sum = fabs(direction[0]) + fabs(direction[1]) + fabs(direction[2]);
    if (!(sum > 0) || !isfinite(sum))
        return bb_fail(BB_INVALID, "%s: view '%s' looks nowhere: give it a direction", what, text);
    return BB_OK;
}

bb_axis_order bb_axis_order_of(const double direction[3])
{
    bb_axis_order order = {{0, 1, 2}, 0};
    /* insertion sort; stable, so equal axes keep their order */
    for (int i = 1; i < 3; i++)
        for (int k = i; k > 0; k--) {
            uint32_t before = order.axis[k - 1], axis = order.axis[k];
            if (fabs(direction[axis]) <= fabs(direction[before]))
                break;
            order.axis[k - 1] = axis;
            order.axis[k] = before;
        }
    for (uint32_t axis = 0; axis < 3; axis++)
        if (direction[axis] < 0)
            order.flips |= 1u << axis;
    return order;
}
