/* Numbered files, one per frame, and frames in between: the same mesh each time, in any supported
 * format of triangles.
 *
 * The last number in the first file's name is counted up, with the same number of digits. Files are
 * read again for each frame; nothing of them is kept.
 */
#include "framework/scene/scene.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const bb_option options_table[] = {
    {"first", NULL, NULL, "the first file; the last number in its name is counted up"},
    {"files", NULL, NULL, "number of files; default: as many as follow without a gap"},
    {"between", "0", NULL, "frames between two files, interpolated linearly"},
    {0},
};

/* With these limits there are fewer than 2^32 frames. */
enum { PATH_CAPACITY = 1024, FILES_MAX = 1000000, BETWEEN_MAX = 1000 };

typedef struct sequence {
    const char *first;
    size_t at, digits; /* position and length of the number in its name */
    uint64_t number;
    uint64_t files, between;
} sequence;

static bb_status find_number(sequence *s)
{
    const char *slash = strrchr(s->first, '/');
    size_t start = slash != NULL ? (size_t)(slash + 1 - s->first) : 0, end = strlen(s->first);
    while (end > start && !isdigit((unsigned char)s->first[end - 1]))
        end--;
    s->at = end;
    while (s->at > start && isdigit((unsigned char)s->first[s->at - 1]))
        s->at--;
    s->digits = end - s->at;
    if (s->digits == 0 || s->digits > 9)
        return bb_fail(BB_INVALID,
                       "scene sequence: the name of '%s' has no number of up to 9 digits to count "
                       "up, as in 'walk_001.obj'",
                       s->first);
    s->number = 0;
    for (size_t i = s->at; i < end; i++)
        s->number = 10 * s->number + (uint64_t)(s->first[i] - '0');
    return BB_OK;
}

static void path_of(const sequence *s, uint64_t file, char path[PATH_CAPACITY])
{
    snprintf(path, PATH_CAPACITY, "%.*s%0*llu%s", (int)s->at, s->first, (int)s->digits,
             (unsigned long long)(s->number + file), s->first + s->at + s->digits);
}

static bool is_there(const sequence *s, uint64_t file)
{
    char path[PATH_CAPACITY];
    path_of(s, file, path);
    return access(path, F_OK) == 0;
}

/* A gap of a few files is a missing frame, not the end. */
static bb_status count_files(sequence *s)
{
    enum { GAP = 10 };
    char path[PATH_CAPACITY];
    uint64_t gap;
    if (!is_there(s, 0))
        return bb_fail(BB_INVALID, "scene sequence: there is no file '%s'", s->first);
    while (s->files < FILES_MAX && is_there(s, s->files))
        s->files++;
    for (gap = 1; gap <= GAP && !is_there(s, s->files + gap); gap++)
        ;
    if (s->files > 1 && gap > GAP)
        return BB_OK;
    path_of(s, s->files, path);
    if (gap > GAP)
        return bb_fail(BB_INVALID, "scene sequence: '%s' is not followed by '%s'", s->first, path);
    if (s->files <= 1)
        return bb_fail(BB_INVALID, "scene sequence: '%s' is missing, and there are files behind it",
                       path);
    return bb_fail(
        BB_INVALID,
        "scene sequence: '%s' is missing, and there are files behind it: give files=%llu "
        "to end there",
        path, (unsigned long long)s->files);
}

static bb_status read_sequence(const bb_spec *spec, const bb_option *options, sequence *s)
{
    *s = (sequence){.first = bb_spec_value(spec, options, "first")};
    if (s->first == NULL)
        return bb_fail(BB_INVALID, "scene sequence: give first=FILE, the file of the first frame");
    if (strlen(s->first) >= PATH_CAPACITY - 16)
        return bb_fail(BB_INVALID, "scene sequence: '%.60s...' is too long", s->first);
    BB_TRY(find_number(s));
    BB_TRY(bb_spec_u64(spec, options, "between", 0, BETWEEN_MAX, &s->between));
    if (bb_spec_value(spec, options, "files") == NULL)
        return count_files(s);
    return bb_spec_u64(spec, options, "files", 2, FILES_MAX, &s->files);
}

/* Loads the mesh of one file. */
static bb_status load(const sequence *s, uint64_t file, bb_scene **scene)
{
    char path[PATH_CAPACITY];
    path_of(s, file, path);
    if (access(path, F_OK) != 0)
        return bb_fail(BB_INVALID, "scene sequence: there is no file '%s'", path);
    BB_TRY(bb_scene_load(path, scene));
    if ((*scene)->kinds == BB_TRIANGLES && (*scene)->volume == NULL)
        return BB_OK;
    bb_scene_free(*scene);
    *scene = NULL;
    return bb_fail(BB_INVALID, "scene sequence: '%s' has other primitives than triangles", path);
}

static bb_status check_same(const sequence *s, uint64_t file, const bb_scene *other,
                            const bb_scene *scene)
{
    char path[PATH_CAPACITY];
    size_t triangles = scene->prims[BB_TRIANGLE].count;
    path_of(s, file, path);
    if (other->vertex_count == scene->vertex_count &&
        other->prims[BB_TRIANGLE].count == triangles &&
        memcmp(other->prims[BB_TRIANGLE].data, scene->prims[BB_TRIANGLE].data,
               3 * triangles * sizeof(uint32_t)) == 0)
        return BB_OK;
    return bb_fail(BB_INVALID,
                   "scene sequence: '%s' has other triangles than '%s' (%u of %u vertices, not %zu "
                   "of %u): a sequence moves one mesh",
                   path, s->first, other->prims[BB_TRIANGLE].count, other->vertex_count, triangles,
                   scene->vertex_count);
}

/* Adds the vertices of a file, times `part`, to those in the scene. */
static bb_status blend(const sequence *s, uint64_t file, double part, bb_scene *scene)
{
    bb_scene *other;
    BB_TRY(load(s, file, &other));
    bb_status status = check_same(s, file, other, scene);
    for (size_t i = 0; status == BB_OK && i < 3 * (size_t)scene->vertex_count; i++)
        scene->vertices[i] = (float)((1 - part) * scene->vertices[i] + part * other->vertices[i]);
    bb_scene_free(other);
    return status;
}

static bb_status set_frame(const bb_spec *spec, const bb_option *options, bb_scene *scene,
                           uint32_t frame)
{
    sequence s;
    BB_TRY(read_sequence(spec, options, &s));
    uint64_t file = frame / (s.between + 1), step = frame % (s.between + 1);
    BB_TRY(blend(&s, file, 1, scene));
    return step == 0 ? BB_OK : blend(&s, file + 1, (double)step / (double)(s.between + 1), scene);
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    sequence s;
    bb_scene *first;
    BB_TRY(read_sequence(spec, options, &s));
    BB_TRY(load(&s, 0, &first));
    uint32_t triangles = first->prims[BB_TRIANGLE].count;
    bb_status status = bb_scene_reserve_mesh(scene, first->vertex_count, triangles);
    if (status == BB_OK) {
        memcpy(scene->vertices, first->vertices, 3ull * first->vertex_count * sizeof(float));
        memcpy(bb_scene_indices(scene), first->prims[BB_TRIANGLE].data,
               3ull * triangles * sizeof(uint32_t));
        scene->frame_count = (uint32_t)((s.files - 1) * (s.between + 1) + 1);
    }
    bb_scene_free(first);
    return status;
}

extern const bb_generator bb_generator_sequence;
const bb_generator bb_generator_sequence = {
    .name = "sequence",
    .summary = "numbered files of one mesh, a frame each",
    .options = options_table,
    .make = make,
    .set_frame = set_frame,
};
