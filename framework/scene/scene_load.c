/* Loads a scene from a specification: a file, a shipped scene, or a generator. */
#include "framework/base/clock.h"
#include "framework/scene/scene_private.h"

#include <dlfcn.h>
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

enum { PARAMETERS_MAX = 512 };

const char *const bb_shipped_scenes[] = {"coffee", "mountain", "scorpion", NULL};

static bool is_folder(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

static bool exists(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0;
}

/* The share folder of the loaded library's installation, even if that was moved. */
static char installed[PATH_MAX + 64];

static void find_installed(void)
{
    Dl_info info;
    char library[PATH_MAX];
    if (dladdr(installed, &info) == 0 || realpath(info.dli_fname, library) == NULL)
        return;
    *strrchr(library, '/') = '\0';
    snprintf(installed, sizeof installed, "%s/" BB_LIBDIR_TO_DATADIR "/bvhbench/scenes/data",
             library);
}

const char *bb_scene_folder(void)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    const char *given = getenv("BVHBENCH_SCENES");
    if (given != NULL && is_folder(given))
        return given;
    pthread_once(&once, find_installed);
    return is_folder(installed) ? installed : BB_SOURCE_DIR "/scenes/data";
}

static bool has_ending(const char *path, const char *ending)
{
    size_t length = strlen(path), size = strlen(ending);
    return length > size && strcasecmp(path + length - size, ending) == 0;
}

/* Finds the format by the file's ending; NULL: not supported. */
static const bb_scene_format *find_format(const char *path)
{
    for (size_t i = 0; bb_scene_formats[i] != NULL; i++)
        for (const char *const *ending = bb_scene_formats[i]->endings; *ending != NULL; ending++)
            if (has_ending(path, *ending))
                return bb_scene_formats[i];
    return NULL;
}

/* Writes the supported endings, as ".a, .b". */
static const char *list_endings(char *text, size_t capacity)
{
    size_t used = 0;
    text[0] = '\0';
    for (size_t i = 0; bb_scene_formats[i] != NULL; i++)
        for (const char *const *e = bb_scene_formats[i]->endings; *e != NULL && used < capacity;
             e++)
            used +=
                (size_t)snprintf(text + used, capacity - used, "%s%s", used > 0 ? ", " : "", *e);
    return text;
}

static bool looks_like_file(const char *text)
{
    return strchr(text, '/') != NULL || find_format(text) != NULL;
}

/* ---- files ---- */

/* Reads NAME.views beside NAME.glb, if it exists; it replaces the file's own cameras. */
static bb_status read_views_beside(const char *path, bb_scene *scene, bool *given)
{
    const char *slash = strrchr(path, '/'), *dot = strrchr(path, '.');
    size_t stem =
        dot != NULL && (slash == NULL || dot > slash) ? (size_t)(dot - path) : strlen(path);
    char views[4096];
    int length = snprintf(views, sizeof views, "%.*s.views", (int)stem, path);
    if (length < 0 || (size_t)length >= sizeof views || !exists(views))
        return BB_OK;
    *given = true;
    return bb_views_read(views, scene->views, BB_VIEWS_MAX, &scene->view_count);
}

/* *given: the scene has all views that it shall have. */
static bb_status load_file(const char *path, const char *parameters, bb_scene *scene, bool *given)
{
    if (!exists(path))
        return bb_fail(BB_INVALID, "%s: there is no such file: check the path", path);
    const bb_scene_format *format = find_format(path);
    char endings[192];
    if (format == NULL)
        return bb_fail(BB_INVALID,
                       "%s: is no scene file that can be read: its ending must be one of %s", path,
                       list_endings(endings, sizeof endings));
    bb_spec spec;
    char text[PARAMETERS_MAX];
    if ((size_t)snprintf(text, sizeof text, "%s%s", format->name, parameters) >= sizeof text)
        return bb_fail(BB_INVALID, "%s: the options behind it are too long", path);
    BB_TRY(bb_spec_parse(text, &spec));
    BB_TRY(bb_spec_validate(&spec, format->options, path));
    BB_TRY(format->load(path, &spec, scene));
    snprintf(scene->source, sizeof scene->source, "%s", format->name);
    return read_views_beside(path, scene, given);
}

static bb_status load_shipped(const bb_spec *spec, bb_scene *scene, bool *given)
{
    BB_TRY(bb_spec_validate(spec, NULL, spec->name));
    char path[4096];
    int length = snprintf(path, sizeof path, "%s/%s.glb", bb_scene_folder(), spec->name);
    if (length < 0 || (size_t)length >= sizeof path)
        return bb_fail(BB_INVALID, "the path of the scenes folder is too long: %.80s...",
                       bb_scene_folder());
    return load_file(path, "", scene, given);
}

/* ---- names ---- */

static bool is_shipped(const char *name)
{
    for (size_t i = 0; bb_shipped_scenes[i] != NULL; i++)
        if (strcmp(bb_shipped_scenes[i], name) == 0)
            return true;
    return false;
}

static const bb_generator *find_generator(const char *name)
{
    for (size_t i = 0; bb_generators[i] != NULL; i++)
        if (strcmp(bb_generators[i]->name, name) == 0)
            return bb_generators[i];
    return NULL;
}

static bb_status unknown(const char *text)
{
    char names[512] = "", endings[192];
    size_t used = 0;
    for (size_t i = 0; bb_shipped_scenes[i] != NULL && used < sizeof names; i++)
        used += (size_t)snprintf(names + used, sizeof names - used, "%s, ", bb_shipped_scenes[i]);
    for (size_t i = 0; bb_generators[i] != NULL && used < sizeof names; i++)
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", bb_generators[i]->name,
                                 bb_generators[i + 1] != NULL ? ", " : "");
    return bb_fail(BB_INVALID, "'%s' is no file and no scene: take a file (%s), or one of %s", text,
                   list_endings(endings, sizeof endings), names);
}

static bb_status load_named(const char *text, bb_scene *scene, bool *given)
{
    bb_spec spec;
    BB_TRY(bb_spec_parse(text, &spec));
    if (is_shipped(spec.name))
        return load_shipped(&spec, scene, given);
    const bb_generator *generator = find_generator(spec.name);
    if (generator == NULL)
        return unknown(text);
    char what[96];
    snprintf(what, sizeof what, "scene %s", generator->name);
    BB_TRY(bb_spec_validate(&spec, generator->options, what));
    snprintf(scene->source, sizeof scene->source, "%s", generator->name);
    BB_TRY(generator->make(&spec, generator->options, scene));
    *given = scene->view_count > 0;
    return bb_scene_remember_motion(generator, text, scene);
}

/* Sets the name; a path that is too long keeps its end, which distinguishes scenes. */
static void set_name(bb_scene *scene, const char *text)
{
    size_t length = strlen(text), room = sizeof scene->name - 1;
    snprintf(scene->name, sizeof scene->name, "%s", length > room ? text + (length - room) : text);
}

/* Splits FILE:key=value... if FILE exists: *parameters begins at the colon. */
static bool split_parameters(const char *text, char path[PATH_MAX], const char **parameters)
{
    for (const char *at = strchr(text, ':'); at != NULL; at = strchr(at + 1, ':')) {
        size_t length = (size_t)(at - text);
        if (length >= PATH_MAX)
            return false;
        memcpy(path, text, length);
        path[length] = '\0';
        *parameters = at;
        if (exists(path) && !is_folder(path))
            return true;
    }
    return false;
}

/* Returns whether the part before the parameters names a scene without a file. */
static bool is_name(const char *text)
{
    char name[64];
    size_t length = strcspn(text, ":");
    if (length >= sizeof name)
        return false;
    memcpy(name, text, length);
    name[length] = '\0';
    return is_shipped(name) || find_generator(name) != NULL;
}

static bb_status load(const char *text, bb_scene *scene)
{
    bool given = false;
    char path[PATH_MAX];
    const char *parameters;
    set_name(scene, text);
    if (exists(text) && !is_folder(text))
        BB_TRY(load_file(text, "", scene, &given));
    else if (is_name(text))
        BB_TRY(load_named(text, scene, &given));
    else if (split_parameters(text, path, &parameters))
        BB_TRY(load_file(path, parameters, scene, &given));
    else if (looks_like_file(text))
        BB_TRY(load_file(text, "", scene, &given));
    else
        BB_TRY(load_named(text, scene, &given));
    given = given || scene->volume != NULL;
    BB_TRY(bb_scene_finish(scene));
    if (scene->prim_count > 0)
        BB_TRY(bb_scene_profile(scene));
    if (!given)
        bb_scene_add_derived_views(scene);
    return BB_OK;
}

bb_status bb_scene_load_any(const char *text, bb_scene **out)
{
    *out = NULL;
    double start = bb_wall_ms();
    bb_scene *scene = calloc(1, sizeof *scene);
    if (scene == NULL)
        return bb_fail(BB_REFUSED, "%s: no memory for a scene", text);
    bb_status status = load(text, scene);
    if (status != BB_OK) {
        bb_scene_free(scene);
        return status;
    }
    scene->load_ms = bb_wall_ms() - start;
    *out = scene;
    return BB_OK;
}

bb_status bb_scene_load(const char *text, bb_scene **out)
{
    BB_TRY(bb_scene_load_any(text, out));
    if ((*out)->prim_count > 0)
        return BB_OK;
    bb_status status = bb_fail(BB_INVALID,
                               "%s: nothing of it is seen with the transfer function '%s': choose "
                               "another (transfer=)",
                               text, (*out)->volume->transfer.name);
    bb_scene_free(*out);
    *out = NULL;
    return status;
}
