/* Hits files, whose sums are made right: what is read is an answer. */
#include "framework/judge/queries.h"
#include "framework/judge/rays.h"
#include "tests/fuzz/exchange.h"

#include <math.h>

enum { RAYS = 8, HASHES = offsetof(bb_hits_header, scene_hash) };

static void check_hits(const bb_scene *scene, const bb_rays *rays, const bb_outside_hits *hits)
{
    FUZZ_CHECK(hits->count > 0 && hits->count <= RAYS);
    FUZZ_CHECK(memchr(hits->tracer, '\0', sizeof hits->tracer) != NULL);
    for (uint32_t i = 0; i < hits->count; i++) {
        const bb_hit *hit = &hits->hits[i];
        bool named = hit->prim < scene->prim_count && isfinite(hit->t);
        bool none = hit->prim == BB_NONE && isinf(hit->t) && hit->t > 0;
        FUZZ_CHECK(named || none || (hit->prim == BB_UNNAMED && rays->query->any));
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static bb_ray lines[RAYS];
    const bb_scene *scene = fuzz_get_cube();
    uint8_t *bytes = (uint8_t *)fuzz_text(data, size);
    bb_rays rays = {.count = RAYS, .rays = lines, .hash = 77};
    if (size >= sizeof(bb_hits_header)) {
        memcpy(bytes + HASHES, &scene->hash, sizeof scene->hash);
        memcpy(bytes + HASHES + sizeof scene->hash, &rays.hash, sizeof rays.hash);
        fuzz_seal(bytes, size, offsetof(bb_hits_header, checksum));
    }
    const char *path = fuzz_file("fuzz.hits", bytes, size);
    for (int any = 0; any < 2; any++) {
        bb_outside_hits hits = {0};
        rays.query = any != 0 ? &bb_query_any : &bb_query_closest;
        bb_status status = bb_exchange_read_hits(path, scene, &rays, &hits);
        if (status == BB_OK)
            check_hits(scene, &rays, &hits);
        else
            fuzz_refused(status);
        FUZZ_CHECK((status == BB_OK) == (hits.hits != NULL));
        bb_outside_hits_release(&hits);
    }
    free(bytes);
    return 0;
}
