/* Rays files and hits files: written from what is in memory, read with suspicion.
 *
 * A reader believes nothing before it has checked it: first what the header says of itself, then its counts against the size
 * of the file (only then is memory taken), then the content against hashes and checksum.
 */
#include "framework/exchange_file.h"

#include "framework/file.h"
#include "framework/memory.h"

#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
               "these files are little-endian: swap bytes here, on a machine that is not");
_Static_assert((int)BB_CLOSEST_HIT == BB_EXCHANGE_CLOSEST && (int)BB_ANY_HIT == BB_EXCHANGE_ANY,
               "queries by the same numbers");

enum { COUNT_MAX = INT32_MAX, PIECE = 1 << 16 };

static const char rays_file[] = "rays file", hits_file[] = "hits file";

/* ---- writing ---- */

static void fill_header(const bb_scene *scene, const bb_rays *rays, const char *generator,
                        bb_rays_header *header)
{
    *header = (bb_rays_header){
        .version = BB_EXCHANGE_VERSION,
        .byte_order = BB_EXCHANGE_ORDER,
        .header_bytes = sizeof *header,
        .query = rays->query,
        .interval = BB_EXCHANGE_OPEN,
        .must_hit = rays->must_hit,
        .ray_count = rays->count,
        .vertex_count = scene->vertex_count,
        .triangle_count = scene->triangle_count,
        .sphere_count = scene->sphere_count,
        .scene_hash = scene->hash,
        .rays_hash = rays->hash,
        .width = rays->width,
        .height = rays->height,
    };
    memcpy(header->magic, BB_RAYS_MAGIC, sizeof header->magic);
    memcpy(header->scene, scene->name, strnlen(scene->name, sizeof header->scene - 1));
    memcpy(header->rays, rays->name, strnlen(rays->name, sizeof header->rays - 1));
    memcpy(header->view, rays->view, strnlen(rays->view, sizeof header->view - 1));
    memcpy(header->generator, generator, strnlen(generator, sizeof header->generator - 1));
}

bb_status bb_exchange_write_rays(const char *path, const bb_scene *scene, const bb_rays *rays,
                                 const char *generator)
{
    bb_rays_header header;
    fill_header(scene, rays, generator, &header);
    const bb_part parts[] = {
        {&header, sizeof header},
        {rays->rays, rays->count * sizeof(bb_ray)},
        {scene->vertices, (size_t)scene->vertex_count * 3 * sizeof(float)},
        {scene->indices, (size_t)scene->triangle_count * 3 * sizeof(uint32_t)},
        {scene->spheres, (size_t)scene->sphere_count * 4 * sizeof(float)},
    };
    enum { PARTS = sizeof parts / sizeof parts[0] };
    XXH3_state_t *sum = XXH3_createState();
    if (sum == NULL)
        return bb_fail(BB_REFUSED, "%s %s: no memory for a checksum", rays_file, path);
    XXH3_64bits_reset(sum);
    for (size_t i = 0; i < PARTS; i++)
        if (parts[i].size > 0)
            XXH3_64bits_update(sum, parts[i].data, parts[i].size);
    header.checksum = XXH3_64bits_digest(sum);
    XXH3_freeState(sum);
    return bb_file_write_parts(path, parts, PARTS, rays_file);
}

/* ---- what both readers do ---- */

/* A file that is read and summed up. */
typedef struct intake {
    bb_input input;
    XXH3_state_t *sum;
} intake;

static bb_status intake_open(const char *path, const char *what, intake *in)
{
    BB_TRY(bb_input_open(path, what, &in->input));
    in->sum = XXH3_createState();
    if (in->sum == NULL) {
        bb_input_close(&in->input);
        return bb_fail(BB_REFUSED, "%s %s: no memory for a checksum", what, path);
    }
    XXH3_64bits_reset(in->sum);
    return BB_OK;
}

static void intake_close(intake *in)
{
    XXH3_freeState(in->sum);
    bb_input_close(&in->input);
}

static bb_status intake_read(intake *in, void *data, size_t size)
{
    BB_TRY(bb_input_read(&in->input, data, size));
    XXH3_64bits_update(in->sum, data, size);
    return BB_OK;
}

/* What both headers begin with. */
typedef struct preamble {
    char magic[8];
    uint32_t version, byte_order, header_bytes;
} preamble;

/* Reads a header of `size` bytes whose checksum lies at `sum_at`; the sum takes that as 0. */
static bb_status read_header(intake *in, const char *magic, void *header, size_t size,
                             size_t sum_at)
{
    const char *path = in->input.path, *what = in->input.what;
    if (in->input.size < size)
        return bb_fail(BB_INVALID, "%s %s has %" PRIu64 " bytes, its header alone has %zu", what,
                       path, in->input.size, size);
    BB_TRY(bb_input_read(&in->input, header, size));
    preamble p;
    memcpy(&p, header, sizeof p);
    if (memcmp(p.magic, magic, sizeof p.magic) != 0)
        return bb_fail(BB_INVALID, "%s %s does not begin with %s: it is something else", what, path,
                       magic);
    if (p.byte_order != BB_EXCHANGE_ORDER)
        return bb_fail(BB_INVALID,
                       "%s %s has byte order %08" PRIx32 ", not %08x: write it little-endian", what,
                       path, p.byte_order, (unsigned)BB_EXCHANGE_ORDER);
    if (p.version != BB_EXCHANGE_VERSION)
        return bb_fail(BB_INVALID, "%s %s is of version %" PRIu32 ", this program reads %d", what,
                       path, p.version, BB_EXCHANGE_VERSION);
    if (p.header_bytes != size)
        return bb_fail(BB_INVALID, "%s %s has a header of %" PRIu32 " bytes, not of %zu", what,
                       path, p.header_bytes, size);
    static const char nothing[sizeof(uint64_t)];
    const char *bytes = header;
    XXH3_64bits_update(in->sum, bytes, sum_at);
    XXH3_64bits_update(in->sum, nothing, sizeof nothing);
    XXH3_64bits_update(in->sum, bytes + sum_at + sizeof nothing, size - sum_at - sizeof nothing);
    return BB_OK;
}

static bb_status check_count(const intake *in, const char *name, uint64_t count)
{
    if (count <= COUNT_MAX)
        return BB_OK;
    return bb_fail(BB_INVALID, "%s %s: %s is %" PRIu64 ", at most %d can be handled",
                   in->input.what, in->input.path, name, count, COUNT_MAX);
}

static bb_status check_size(const intake *in, uint64_t expected)
{
    if (in->input.size == expected)
        return BB_OK;
    return bb_fail(BB_INVALID,
                   "%s %s has %" PRIu64 " bytes, by its header it has %" PRIu64 ": it is %s",
                   in->input.what, in->input.path, in->input.size, expected,
                   in->input.size < expected ? "truncated" : "too long");
}

static bb_status check_sum(const intake *in, uint64_t checksum)
{
    uint64_t sum = XXH3_64bits_digest(in->sum);
    if (sum == checksum)
        return BB_OK;
    return bb_fail(BB_INVALID,
                   "%s %s is damaged: its checksum is %016" PRIx64 ", its header says %016" PRIx64,
                   in->input.what, in->input.path, sum, checksum);
}

/* Ends with a 0, nothing but 0 after it, and nothing that moves a terminal's cursor. */
static bool is_text(const char *text, size_t capacity)
{
    size_t length = strnlen(text, capacity);
    for (size_t i = 0; i < length; i++)
        if ((unsigned char)text[i] < ' ' || text[i] == 0x7F)
            return false;
    for (size_t i = length; i < capacity; i++)
        if (text[i] != '\0')
            return false;
    return length < capacity;
}

static bb_status check_text(const intake *in, const char *name, const char *text, size_t capacity)
{
    if (is_text(text, capacity))
        return BB_OK;
    return bb_fail(BB_INVALID, "%s %s: %s is no text that ends with a 0 and is filled up with 0",
                   in->input.what, in->input.path, name);
}

/* ---- reading rays ---- */

static bb_status check_rays_header(const intake *in, const bb_rays_header *header)
{
    const char *path = in->input.path;
    if (header->query != BB_EXCHANGE_CLOSEST && header->query != BB_EXCHANGE_ANY)
        return bb_fail(BB_INVALID, "rays file %s: query is %" PRIu32 ", must be %d or %d", path,
                       header->query, BB_EXCHANGE_CLOSEST, BB_EXCHANGE_ANY);
    if (header->interval != BB_EXCHANGE_OPEN)
        return bb_fail(BB_INVALID, "rays file %s: interval is %" PRIu32 ", must be %d (open)", path,
                       header->interval, BB_EXCHANGE_OPEN);
    if (header->must_hit > 1)
        return bb_fail(BB_INVALID, "rays file %s: must_hit is %" PRIu32 ", must be 0 or 1", path,
                       header->must_hit);
    BB_TRY(check_count(in, "ray_count", header->ray_count));
    BB_TRY(check_count(in, "triangle_count", header->triangle_count));
    BB_TRY(check_count(in, "sphere_count", header->sphere_count));
    if (header->vertex_count > UINT32_MAX)
        return bb_fail(BB_INVALID, "rays file %s: vertex_count is %" PRIu64 ", more than 2^32 - 1",
                       path, header->vertex_count);
    if (header->ray_count == 0)
        return bb_fail(BB_INVALID, "rays file %s has no ray", path);
    if (header->width != 0 || header->height != 0)
        if ((uint64_t)header->width * header->height != header->ray_count)
            return bb_fail(BB_INVALID,
                           "rays file %s: a picture of %" PRIu32 "x%" PRIu32 " has not %" PRIu64
                           " rays",
                           path, header->width, header->height, header->ray_count);
    BB_TRY(check_text(in, "scene", header->scene, sizeof header->scene));
    BB_TRY(check_text(in, "rays", header->rays, sizeof header->rays));
    BB_TRY(check_text(in, "view", header->view, sizeof header->view));
    BB_TRY(check_text(in, "generator", header->generator, sizeof header->generator));
    /* below 2^31 rays, primitives and so on: no sum of them overflows */
    return check_size(in, sizeof *header + header->ray_count * sizeof(bb_ray) +
                              header->vertex_count * 3 * sizeof(float) +
                              header->triangle_count * 3 * sizeof(uint32_t) +
                              header->sphere_count * 4 * sizeof(float));
}

static bb_status check_scene(const char *path, const bb_rays_header *header, const bb_scene *scene)
{
    if (header->scene_hash == scene->hash && header->vertex_count == scene->vertex_count &&
        header->triangle_count == scene->triangle_count &&
        header->sphere_count == scene->sphere_count)
        return BB_OK;
    return bb_fail(BB_INVALID,
                   "rays file %s is of another scene: of %.80s with hash %016" PRIx64
                   ", %s has %016" PRIx64,
                   path, header->scene, header->scene_hash, scene->name, scene->hash);
}

static bb_status describe(const char *path, const bb_rays_header *header, bb_rays *rays)
{
    memcpy(rays->name, header->rays, sizeof rays->name);
    memcpy(rays->view, header->view, sizeof rays->view);
    BB_TRY(bb_spec_parse(rays->name, &rays->spec));
    rays->workload = bb_workload_find(rays->spec.name);
    if (rays->workload == NULL || (uint32_t)rays->workload->query != header->query)
        return bb_fail(BB_INVALID, "rays file %s: there are no rays '%s' for this query", path,
                       rays->spec.name);
    char what[512];
    snprintf(what, sizeof what, "rays file %s: rays %s", path, rays->workload->name);
    BB_TRY(bb_spec_validate(&rays->spec, rays->workload->options, what));
    rays->query = rays->workload->query;
    rays->must_hit = header->must_hit != 0;
    rays->width = header->width;
    rays->height = header->height;
    return BB_OK;
}

/* The part of the scene that `data` holds must be the next in the file. */
static bb_status compare(intake *in, const void *data, size_t size)
{
    char piece[PIECE];
    for (size_t done = 0; done < size;) {
        size_t part = size - done < PIECE ? size - done : PIECE;
        BB_TRY(intake_read(in, piece, part));
        if (memcmp(piece, (const char *)data + done, part) != 0)
            return bb_fail(BB_INVALID,
                           "rays file %s is damaged: its primitives are not the scene's",
                           in->input.path);
        done += part;
    }
    return BB_OK;
}

static bb_status read_rays(intake *in, const bb_scene *scene, bb_rays *rays)
{
    const char *path = in->input.path;
    bb_rays_header header;
    BB_TRY(
        read_header(in, BB_RAYS_MAGIC, &header, sizeof header, offsetof(bb_rays_header, checksum)));
    BB_TRY(check_rays_header(in, &header));
    BB_TRY(check_scene(path, &header, scene));
    BB_TRY(describe(path, &header, rays));
    size_t bytes = (size_t)header.ray_count * sizeof(bb_ray);
    BB_TRY(bb_host_alloc(NULL, bytes, "rays", &rays->rays));
    rays->count = (uint32_t)header.ray_count;
    BB_TRY(intake_read(in, rays->rays, bytes));
    BB_TRY(compare(in, scene->vertices, (size_t)scene->vertex_count * 3 * sizeof(float)));
    BB_TRY(compare(in, scene->indices, (size_t)scene->triangle_count * 3 * sizeof(uint32_t)));
    BB_TRY(compare(in, scene->spheres, (size_t)scene->sphere_count * 4 * sizeof(float)));
    BB_TRY(check_sum(in, header.checksum));
    rays->hash = bb_rays_hash(rays);
    if (rays->hash != header.rays_hash)
        return bb_fail(BB_INVALID,
                       "rays file %s is damaged: its rays have hash %016" PRIx64
                       ", its header says %016" PRIx64,
                       path, rays->hash, header.rays_hash);
    if (bb_rays_check(scene, rays) == BB_OK)
        return BB_OK;
    char reason[512];
    snprintf(reason, sizeof reason, "%s", bb_message());
    return bb_fail(BB_INVALID, "rays file %s: %s", path, reason);
}

bb_status bb_exchange_read_rays(const char *path, const bb_scene *scene, bb_rays **out)
{
    *out = NULL;
    intake in;
    BB_TRY(intake_open(path, rays_file, &in));
    bb_status status = BB_OK;
    bb_rays *rays = calloc(1, sizeof *rays);
    if (rays == NULL)
        status = bb_fail(BB_REFUSED, "%s %s: no memory for a ray set", rays_file, path);
    if (status == BB_OK)
        status = read_rays(&in, scene, rays);
    intake_close(&in);
    if (status != BB_OK) {
        bb_rays_free(rays);
        return status;
    }
    *out = rays;
    return BB_OK;
}

/* ---- reading hits ---- */

static bb_status check_hits_header(const intake *in, const bb_hits_header *header,
                                   const bb_scene *scene, const bb_rays *rays)
{
    const char *path = in->input.path;
    if (header->reserved != 0)
        return bb_fail(BB_INVALID, "hits file %s: reserved is %" PRIu32 ", must be 0", path,
                       header->reserved);
    if (header->scene_hash != scene->hash || header->rays_hash != rays->hash)
        return bb_fail(BB_INVALID,
                       "hits file %s answers other rays: of scene %016" PRIx64 ", rays %016" PRIx64
                       "; the rays file has scene %016" PRIx64 ", rays %016" PRIx64,
                       path, header->scene_hash, header->rays_hash, scene->hash, rays->hash);
    if (header->hit_count > rays->count)
        return bb_fail(BB_INVALID, "hits file %s has %" PRIu64 " hits for %" PRIu32 " rays", path,
                       header->hit_count, rays->count);
    if (header->hit_count == 0)
        return bb_fail(BB_INVALID, "hits file %s has no hit", path);
    BB_TRY(check_text(in, "tracer", header->tracer, sizeof header->tracer));
    return check_size(in, sizeof *header + header->hit_count * sizeof(bb_hit));
}

static bool is_answer(const bb_scene *scene, bb_query query, const bb_hit *hit)
{
    if (hit->prim == BB_NONE)
        return isinf(hit->t) && hit->t > 0;
    if (hit->prim == BB_UNNAMED)
        return query == BB_ANY_HIT;
    return hit->prim < scene->prim_count && isfinite(hit->t);
}

static bb_status check_hits(const char *path, const bb_scene *scene, const bb_rays *rays,
                            const bb_outside_hits *hits)
{
    for (uint32_t i = 0; i < hits->count; i++)
        if (!is_answer(scene, rays->query, &hits->hits[i]))
            return bb_fail(BB_INVALID,
                           "hits file %s: t = %g, primitive %" PRIu32
                           " is no answer to ray %" PRIu32 ": write a number and one of %" PRIu32
                           " primitives, or t = inf and %" PRIu32 " for a miss",
                           path, (double)hits->hits[i].t, hits->hits[i].prim, i, scene->prim_count,
                           BB_NONE);
    return BB_OK;
}

static bb_status read_hits(intake *in, const bb_scene *scene, const bb_rays *rays,
                           bb_outside_hits *out)
{
    bb_hits_header header;
    BB_TRY(
        read_header(in, BB_HITS_MAGIC, &header, sizeof header, offsetof(bb_hits_header, checksum)));
    BB_TRY(check_hits_header(in, &header, scene, rays));
    size_t bytes = (size_t)header.hit_count * sizeof(bb_hit);
    BB_TRY(bb_host_alloc(NULL, bytes, "an outside tracer's hits", &out->hits));
    out->count = (uint32_t)header.hit_count;
    memcpy(out->tracer, header.tracer, sizeof out->tracer);
    BB_TRY(intake_read(in, out->hits, bytes));
    if (header.checksum != 0)
        BB_TRY(check_sum(in, header.checksum));
    return check_hits(in->input.path, scene, rays, out);
}

bb_status bb_exchange_read_hits(const char *path, const bb_scene *scene, const bb_rays *rays,
                                bb_outside_hits *out)
{
    intake in;
    BB_TRY(intake_open(path, hits_file, &in));
    bb_status status = read_hits(&in, scene, rays, out);
    intake_close(&in);
    if (status != BB_OK)
        bb_outside_hits_release(out);
    return status;
}

void bb_outside_hits_release(bb_outside_hits *hits)
{
    bb_host_free(hits->hits);
    *hits = (bb_outside_hits){0};
}
