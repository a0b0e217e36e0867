/* Writes rays files, and reads rays files and hits files that may be damaged or hostile.
 *
 * A reader checks the header first, then its counts against the size of the file, and only then
 * takes memory. Last it checks the content against hashes and checksum.
 */
#include "framework/workload/exchange_file.h"

#include "framework/base/file.h"
#include "framework/base/memory.h"
#include "framework/judge/queries.h"
#include "framework/scene/prim.h"
#include "framework/workload/exchange_intake.h"
#include "framework/workload/workload.h"

#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

enum { PIECE = 1 << 16 };

static const char rays_file[] = "rays file", hits_file[] = "hits file";

/* ---- writing ---- */

/* Kinds of primitives after the first two, whose counts have members of their own. */
enum { MORE = BB_SPHERE + 1, MORE_COUNT = BB_KIND_COUNT - MORE };
BB_STATIC_ASSERT((int)MORE_COUNT <= (int)BB_EXCHANGE_MORE_KINDS, "room for all kinds");

static void fill_header(const bb_scene *scene, const bb_rays *rays, const char *generator,
                        bb_rays_header *header)
{
    *header = (bb_rays_header){
        .version = BB_EXCHANGE_VERSION,
        .byte_order = BB_EXCHANGE_ORDER,
        .header_bytes = sizeof *header,
        .query = rays->query->exchange,
        .interval = BB_EXCHANGE_OPEN,
        .must_hit = rays->must_hit,
        .ray_count = rays->count,
        .vertex_count = scene->vertex_count,
        .triangle_count = scene->prims[BB_TRIANGLE].count,
        .sphere_count = scene->prims[BB_SPHERE].count,
        .scene_hash = scene->hash,
        .rays_hash = rays->hash,
        .seed = rays->seed,
        .width = rays->width,
        .height = rays->height,
        .primary_width = rays->primary_width,
        .primary_height = rays->primary_height,
        .max_rays = rays->max_rays,
    };
    for (int more = 0; more < MORE_COUNT; more++)
        header->more_counts[more] = scene->prims[MORE + more].count;
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
    if (!rays->query->is_hit)
        return bb_fail(BB_UNSUPPORTED,
                       "rays '%s': outside tracers answer with hits, and these rays ask for more: "
                       "take others, or another query of theirs",
                       rays->name);
    fill_header(scene, rays, generator, &header);
    enum { PARTS = 3 + BB_KIND_COUNT };
    bb_file_part parts[PARTS] = {
        {&header, sizeof header},
        {rays->rays, rays->count * sizeof(bb_ray)},
        {scene->vertices, (size_t)scene->vertex_count * 3 * sizeof(float)},
    };
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        parts[3 + kind] =
            (bb_file_part){scene->prims[kind].data, scene->prims[kind].count * bb_prim_bytes(kind)};
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

/* ---- reading rays ---- */

/* Returns the query of the header's number; NULL: there is none. */
static const bb_query *query_of(const bb_rays_header *header)
{
    for (const bb_query *const *query = bb_queries; *query != NULL; query++)
        if ((*query)->is_hit && (*query)->exchange == header->query)
            return *query;
    return NULL;
}

/* Checks more_counts, and adds the bytes of these primitives. */
static bb_status check_more_counts(const bb_intake *in, const bb_rays_header *header,
                                   uint64_t *bytes)
{
    for (int k = 0; k < BB_EXCHANGE_MORE_KINDS; k++) {
        BB_TRY(bb_intake_check_count(in, "more_counts", header->more_counts[k]));
        if (header->more_counts[k] > 0 && k >= MORE_COUNT)
            return bb_fail(BB_INVALID,
                           "rays file %s: more_counts[%d] is %" PRIu64
                           ", a kind of primitive that this program does not know",
                           in->input.path, k, header->more_counts[k]);
        if (k < MORE_COUNT)
            *bytes += header->more_counts[k] * bb_prim_bytes((uint32_t)(MORE + k));
    }
    return BB_OK;
}

static bb_status check_rays_header(const bb_intake *in, const bb_rays_header *header)
{
    const char *path = in->input.path;
    if (query_of(header) == NULL)
        return bb_fail(BB_INVALID, "rays file %s: query is %" PRIu32 ", must be %d or %d", path,
                       header->query, BB_EXCHANGE_CLOSEST, BB_EXCHANGE_ANY);
    if (header->interval != BB_EXCHANGE_OPEN)
        return bb_fail(BB_INVALID, "rays file %s: interval is %" PRIu32 ", must be %d (open)", path,
                       header->interval, BB_EXCHANGE_OPEN);
    if (header->must_hit > 1)
        return bb_fail(BB_INVALID, "rays file %s: must_hit is %" PRIu32 ", must be 0 or 1", path,
                       header->must_hit);
    if (header->reserved != 0)
        return bb_fail(BB_INVALID, "rays file %s: reserved is %" PRIu32 ", must be 0", path,
                       header->reserved);
    BB_TRY(bb_intake_check_count(in, "ray_count", header->ray_count));
    BB_TRY(bb_intake_check_count(in, "max_rays", header->max_rays));
    BB_TRY(bb_intake_check_count(in, "triangle_count", header->triangle_count));
    BB_TRY(bb_intake_check_count(in, "sphere_count", header->sphere_count));
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
    BB_TRY(bb_intake_check_text(in, "scene", header->scene, sizeof header->scene));
    BB_TRY(bb_intake_check_text(in, "rays", header->rays, sizeof header->rays));
    BB_TRY(bb_intake_check_text(in, "view", header->view, sizeof header->view));
    BB_TRY(bb_intake_check_text(in, "generator", header->generator, sizeof header->generator));
    /* each count is below 2^31, so the sum does not overflow */
    uint64_t bytes = sizeof *header + header->ray_count * sizeof(bb_ray) +
                     header->vertex_count * 3 * sizeof(float) +
                     header->triangle_count * 3 * sizeof(uint32_t) +
                     header->sphere_count * 4 * sizeof(float);
    BB_TRY(check_more_counts(in, header, &bytes));
    return bb_intake_check_size(in, bytes);
}

static bool same_more_counts(const bb_rays_header *header, const bb_scene *scene)
{
    bool same = true;
    for (int k = 0; k < MORE_COUNT; k++)
        same = same && header->more_counts[k] == scene->prims[MORE + k].count;
    return same;
}

static bb_status check_scene(const char *path, const bb_rays_header *header, const bb_scene *scene)
{
    if (header->scene_hash == scene->hash && header->vertex_count == scene->vertex_count &&
        header->triangle_count == scene->prims[BB_TRIANGLE].count &&
        header->sphere_count == scene->prims[BB_SPHERE].count && same_more_counts(header, scene))
        return BB_OK;
    return bb_fail(BB_INVALID,
                   "rays file %s is of another scene: of %.80s with hash %016" PRIx64
                   ", %s has %016" PRIx64,
                   path, header->scene, header->scene_hash, scene->name, scene->hash);
}

/* Checks the header's query and must_hit against the workload. */
static bb_status check_workload(const char *path, const bb_scene *scene,
                                const bb_rays_header *header, const bb_spec *spec,
                                const bb_workload *workload)
{
    if (workload == NULL || workload->query != query_of(header))
        return bb_fail(
            BB_INVALID,
            "rays file %s: there are no rays '%s' for this query; rays made by hand need "
            "--verify no",
            path, spec->name);
    char what[512];
    snprintf(what, sizeof what, "rays file %s: rays %s", path, workload->name);
    BB_TRY(bb_spec_validate(spec, workload->options, what));
    bool must_hit = bb_workload_must_hit(workload, scene, spec);
    if (must_hit != (header->must_hit != 0))
        return bb_fail(BB_INVALID,
                       "rays file %s: must_hit is %" PRIu32
                       ", for rays '%s' it is %d: make it anew",
                       path, header->must_hit, spec->text, must_hit);
    return BB_OK;
}

/* Checks that rays made by hand name no workload and have 0 where a workload would have a value. */
static bb_status check_by_hand(const char *path, const bb_rays_header *header, const bb_spec *spec,
                               const bb_workload *workload)
{
    if (workload != NULL)
        return bb_fail(BB_INVALID,
                       "rays file %s: '%s' names a workload, whose rays are always made again: "
                       "leave out --verify no, or give rays made by hand another name",
                       path, spec->name);
    if (header->must_hit != 0 || header->seed != 0 || header->primary_width != 0 ||
        header->primary_height != 0 || header->max_rays != 0)
        return bb_fail(
            BB_INVALID,
            "rays file %s: must_hit, seed, primary_width, primary_height and max_rays of "
            "rays made by hand must be 0",
            path);
    return BB_OK;
}

static bb_status describe(const char *path, const bb_scene *scene, const bb_rays_header *header,
                          bool by_hand, bb_rays *rays)
{
    memcpy(rays->name, header->rays, sizeof rays->name);
    memcpy(rays->view, header->view, sizeof rays->view);
    BB_TRY(bb_spec_parse(rays->name, &rays->spec));
    const bb_workload *workload = bb_workload_find(rays->spec.name);
    BB_TRY(by_hand ? check_by_hand(path, header, &rays->spec, workload)
                   : check_workload(path, scene, header, &rays->spec, workload));
    rays->options = workload != NULL ? workload->options : NULL;
    rays->query = query_of(header);
    rays->must_hit = workload != NULL && bb_workload_must_hit(workload, scene, &rays->spec);
    rays->width = header->width;
    rays->height = header->height;
    rays->seed = header->seed;
    rays->primary_width = header->primary_width;
    rays->primary_height = header->primary_height;
    rays->max_rays = header->max_rays;
    return BB_OK;
}

/* Checks that the next `size` bytes of the file equal `data`, a part of the scene. */
static bb_status compare(bb_intake *in, const void *data, size_t size)
{
    char piece[PIECE];
    for (size_t done = 0; done < size;) {
        size_t part = size - done < PIECE ? size - done : PIECE;
        BB_TRY(bb_intake_read(in, piece, part));
        if (memcmp(piece, (const char *)data + done, part) != 0)
            return bb_fail(BB_INVALID,
                           "rays file %s is damaged: its primitives are not the scene's",
                           in->input.path);
        done += part;
    }
    return BB_OK;
}

static bb_status read_rays(bb_intake *in, const bb_scene *scene, bool by_hand, bb_rays *rays)
{
    const char *path = in->input.path;
    bb_rays_header header;
    BB_TRY(bb_intake_header(in, BB_RAYS_MAGIC, &header, sizeof header,
                            offsetof(bb_rays_header, checksum)));
    BB_TRY(check_rays_header(in, &header));
    BB_TRY(check_scene(path, &header, scene));
    BB_TRY(describe(path, scene, &header, by_hand, rays));
    size_t bytes = (size_t)header.ray_count * sizeof(bb_ray);
    BB_TRY(bb_host_alloc(NULL, bytes, "rays", &rays->rays));
    rays->count = (uint32_t)header.ray_count;
    BB_TRY(bb_intake_read(in, rays->rays, bytes));
    BB_TRY(compare(in, scene->vertices, (size_t)scene->vertex_count * 3 * sizeof(float)));
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        BB_TRY(
            compare(in, scene->prims[kind].data, scene->prims[kind].count * bb_prim_bytes(kind)));
    BB_TRY(bb_intake_check_sum(in, header.checksum));
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

bb_status bb_exchange_read_rays(const char *path, const bb_scene *scene, bool by_hand,
                                bb_rays **out)
{
    *out = NULL;
    bb_intake in;
    BB_TRY(bb_intake_open(path, rays_file, &in));
    bb_status status = BB_OK;
    bb_rays *rays = calloc(1, sizeof *rays);
    if (rays == NULL)
        status = bb_fail(BB_REFUSED, "%s %s: no memory for a ray set", rays_file, path);
    if (status == BB_OK)
        status = read_rays(&in, scene, by_hand, rays);
    bb_intake_close(&in);
    if (status != BB_OK) {
        bb_rays_free(rays);
        return status;
    }
    *out = rays;
    return BB_OK;
}

/* ---- reading hits ---- */

static bb_status check_hits_header(const bb_intake *in, const bb_hits_header *header,
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
    BB_TRY(bb_intake_check_text(in, "tracer", header->tracer, sizeof header->tracer));
    return bb_intake_check_size(in, sizeof *header + header->hit_count * sizeof(bb_hit));
}

static bool is_answer(const bb_scene *scene, const bb_query *query, const bb_hit *hit)
{
    if (hit->prim == BB_NONE)
        return isinf(hit->t) && hit->t > 0;
    if (hit->prim == BB_UNNAMED)
        return query->any;
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

static bb_status read_hits(bb_intake *in, const bb_scene *scene, const bb_rays *rays,
                           bb_outside_hits *out)
{
    bb_hits_header header;
    BB_TRY(bb_intake_header(in, BB_HITS_MAGIC, &header, sizeof header,
                            offsetof(bb_hits_header, checksum)));
    BB_TRY(check_hits_header(in, &header, scene, rays));
    size_t bytes = (size_t)header.hit_count * sizeof(bb_hit);
    BB_TRY(bb_host_alloc(NULL, bytes, "an outside tracer's hits", &out->hits));
    out->count = (uint32_t)header.hit_count;
    memcpy(out->tracer, header.tracer, sizeof out->tracer);
    BB_TRY(bb_intake_read(in, out->hits, bytes));
    if (header.checksum != 0)
        BB_TRY(bb_intake_check_sum(in, header.checksum));
    return check_hits(in->input.path, scene, rays, out);
}

bb_status bb_exchange_read_hits(const char *path, const bb_scene *scene, const bb_rays *rays,
                                bb_outside_hits *out)
{
    bb_intake in;
    BB_TRY(bb_intake_open(path, hits_file, &in));
    bb_status status = read_hits(&in, scene, rays, out);
    bb_intake_close(&in);
    if (status != BB_OK)
        bb_outside_hits_release(out);
    return status;
}

void bb_outside_hits_release(bb_outside_hits *hits)
{
    bb_host_free(hits->hits);
    *hits = (bb_outside_hits){0};
}
