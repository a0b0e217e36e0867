/* Reads views from a text file, one per line, `name key=value ...` (format: scenes/README.md), and
 * makes names of views from elsewhere valid. */
#include "framework/scene/scene.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINE_LIMIT = 1024 };

enum { HAS_EYE = 1, HAS_TARGET = 2, HAS_UP = 4, HAS_FOV = 8, HAS_PARALLEL = 16 };

/* Reads one finite number; *end: the rest of the text. */
static bool read_number(const char *text, char **end, double *out)
{
    *out = strtod(text, end);
    return *end != text && isfinite(*out);
}

static bool read_vector(const char *text, double out[3])
{
    char *end;
    for (int axis = 0; axis < 3; axis++) {
        if (!read_number(text, &end, &out[axis]) || *end != (axis < 2 ? ',' : '\0'))
            return false;
        text = end + 1;
    }
    return true;
}

static bool read_single(const char *text, double *out)
{
    char *end;
    return read_number(text, &end, out) && *end == '\0';
}

/* Reads one key=value; returns the bit of the key, 0 if it is invalid. */
static unsigned read_item(const char *key, const char *value, bb_view *view)
{
    if (strcmp(key, "eye") == 0)
        return read_vector(value, view->eye) ? HAS_EYE : 0;
    if (strcmp(key, "target") == 0)
        return read_vector(value, view->target) ? HAS_TARGET : 0;
    if (strcmp(key, "up") == 0)
        return read_vector(value, view->up) ? HAS_UP : 0;
    if (strcmp(key, "fov") == 0)
        return read_single(value, &view->fov_y) ? HAS_FOV : 0;
    if (strcmp(key, "parallel") == 0)
        return read_single(value, &view->fov_y) ? HAS_PARALLEL : 0;
    return 0;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Returns why a line is no camera; NULL if it is one. */
static const char *find_fault(unsigned seen, const bb_view *view)
{
    if ((seen & HAS_EYE) == 0 || (seen & HAS_TARGET) == 0 || (seen & HAS_UP) == 0)
        return "needs eye=, target= and up=";
    if ((seen & HAS_FOV) != 0 && (seen & HAS_PARALLEL) != 0)
        return "has fov= and parallel=: one must go";
    if ((seen & (HAS_FOV | HAS_PARALLEL)) == 0)
        return "needs fov= (degrees) or parallel= (height of the picture)";
    if ((seen & HAS_FOV) != 0 && !(view->fov_y >= 1 && view->fov_y <= 170))
        return "has a fov that is not from 1 to 170 degrees";
    if ((seen & HAS_PARALLEL) != 0 && !(view->fov_y > 0))
        return "has a parallel= that is not above 0";
    double ahead[3];
    for (int axis = 0; axis < 3; axis++)
        ahead[axis] = view->target[axis] - view->eye[axis];
    double ahead2 = dot(ahead, ahead), up2 = dot(view->up, view->up), both = dot(ahead, view->up);
    if (!(ahead2 > 0) || !isfinite(ahead2))
        return "has its eye at its target";
    if (!(up2 > 0) || !isfinite(up2) || both * both > ahead2 * up2 * (1 - 1e-9))
        return "has an up that is zero or points along the view";
    return NULL;
}

static bb_status read_line(const char *path, uint32_t line, char *text, bb_view *view)
{
    memset(view, 0, sizeof *view);
    unsigned seen = 0;
    char *rest = NULL;
    const char *name = strtok_r(text, " \t\r\n", &rest);
    if (strlen(name) >= sizeof view->name || strchr(name, '=') != NULL)
        return bb_fail(BB_INVALID,
                       "%s:%u: '%.60s' is no name of a view (up to %zu characters, no '=')", path,
                       line, name, sizeof view->name - 1);
    strcpy(view->name, name);
    for (char *item; (item = strtok_r(NULL, " \t\r\n", &rest)) != NULL;) {
        char *value = strchr(item, '=');
        if (value != NULL)
            *value++ = '\0';
        unsigned bit = value != NULL ? read_item(item, value, view) : 0;
        if (bit == 0)
            return bb_fail(BB_INVALID,
                           "%s:%u: '%.60s%s%.60s' is none of eye=x,y,z target=x,y,z up=x,y,z "
                           "fov=DEGREES parallel=HEIGHT",
                           path, line, item, value != NULL ? "=" : "", value != NULL ? value : "");
        if ((seen & bit) != 0)
            return bb_fail(BB_INVALID, "%s:%u: %s= is given twice", path, line, item);
        seen |= bit;
    }
    const char *fault = find_fault(seen, view);
    if (fault != NULL)
        return bb_fail(BB_INVALID, "%s:%u: view '%s' %s", path, line, view->name, fault);
    view->parallel = (seen & HAS_PARALLEL) != 0;
    return BB_OK;
}

static bb_status read_lines(const char *path, FILE *file, bb_view *views, uint32_t capacity,
                            uint32_t *count)
{
    char text[LINE_LIMIT];
    for (uint32_t line = 1; fgets(text, sizeof text, file) != NULL; line++) {
        if (strlen(text) == sizeof text - 1 && text[sizeof text - 2] != '\n')
            return bb_fail(BB_INVALID, "%s:%u: is longer than %d characters", path, line,
                           LINE_LIMIT - 2);
        text[strcspn(text, "#")] = '\0';
        if (text[strspn(text, " \t\r\n")] == '\0')
            continue;
        bb_view view;
        BB_TRY(read_line(path, line, text, &view));
        for (uint32_t i = 0; i < *count; i++)
            if (strcmp(views[i].name, view.name) == 0)
                return bb_fail(BB_INVALID, "%s:%u: there is a view '%s' already", path, line,
                               view.name);
        if (*count == capacity)
            return bb_fail(BB_INVALID, "%s:%u: there are more than %u views", path, line, capacity);
        views[(*count)++] = view;
    }
    if (ferror(file))
        return bb_fail(BB_INVALID, "%s: cannot be read: %s", path, strerror(errno));
    if (*count == 0)
        return bb_fail(BB_INVALID, "%s: has no view: write one per line, or remove the file", path);
    return BB_OK;
}

bb_status bb_views_read(const char *path, bb_view *views, uint32_t capacity, uint32_t *count)
{
    *count = 0;
    FILE *file = fopen(path, "r");
    if (file == NULL)
        return bb_fail(BB_INVALID, "%s: %s", path, strerror(errno));
    bb_status status = read_lines(path, file, views, capacity, count);
    if (status != BB_OK)
        *count = 0;
    fclose(file);
    return status;
}

/* ---- names ---- */

/* Replaces characters that keys, options and file names cannot have. */
static void make_safe(const char *name, char *out, size_t capacity)
{
    size_t used = 0;
    for (; *name != '\0' && used + 1 < capacity; name++) {
        bool plain = (*name >= '0' && *name <= '9') || (*name >= 'A' && *name <= 'Z') ||
                     (*name >= 'a' && *name <= 'z') || *name == '_' || (*name == '.' && used > 0);
        if (plain)
            out[used++] = *name;
        else if (used > 0 && out[used - 1] != '-')
            out[used++] = '-';
    }
    while (used > 0 && out[used - 1] == '-')
        used--;
    out[used] = '\0';
}

static bool is_taken(const bb_scene *scene, const char *name)
{
    for (uint32_t i = 0; i < scene->view_count; i++)
        if (strcmp(scene->views[i].name, name) == 0)
            return true;
    return false;
}

void bb_scene_add_view(bb_scene *scene, const char *name, const bb_view *view)
{
    char plain[sizeof view->name - 4]; /* room for -2 to -16 */
    if (scene->view_count == BB_VIEWS_MAX)
        return;
    make_safe(name, plain, sizeof plain);
    bb_view named = *view;
    memset(named.name, 0, sizeof named.name);
    const char *base = plain[0] != '\0' ? plain : "view";
    strcpy(named.name, base);
    for (unsigned n = 2; is_taken(scene, named.name); n++)
        snprintf(named.name, sizeof named.name, "%s-%u", base, n);
    scene->views[scene->view_count++] = named;
}
