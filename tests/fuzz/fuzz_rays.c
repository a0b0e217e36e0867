/* Rays files, whose sums are made right. What is read can be written, and then is what it was. */
#include "framework/judge/rays.h"
#include "tests/fuzz/exchange.h"

#include <math.h>

/* Of the rays that the header says there are, if there are. */
static void put_rays_hash(uint8_t *bytes, size_t size)
{
    bb_rays_header header;
    memcpy(&header, bytes, sizeof header);
    if (header.ray_count > (size - sizeof header) / sizeof(bb_ray))
        return;
    header.rays_hash =
        XXH3_64bits(bytes + sizeof header, (size_t)header.ray_count * sizeof(bb_ray));
    memcpy(bytes, &header, sizeof header);
}

static void check_rays(const bb_scene *scene, const bb_rays *rays, bool by_hand)
{
    bb_rays *again = NULL;
    FUZZ_CHECK(rays->count > 0 && rays->query != NULL);
    for (uint32_t i = 0; i < rays->count; i++)
        FUZZ_CHECK(!isnan(rays->rays[i].o[0]) && !isnan(rays->rays[i].d[0]));
    const char *path = fuzz_path("again.rays");
    FUZZ_CHECK(bb_exchange_write_rays(path, scene, rays, "test") == BB_OK);
    FUZZ_CHECK(bb_exchange_read_rays(path, scene, by_hand, &again) == BB_OK);
    FUZZ_CHECK(again->count == rays->count && again->hash == rays->hash);
    FUZZ_CHECK(strcmp(again->name, rays->name) == 0 && strcmp(again->view, rays->view) == 0);
    FUZZ_CHECK(again->seed == rays->seed && again->width == rays->width);
    bb_rays_free(again);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const bb_scene *scene = fuzz_get_cube();
    uint8_t *bytes = (uint8_t *)fuzz_text(data, size);
    if (size >= sizeof(bb_rays_header)) {
        put_rays_hash(bytes, size);
        fuzz_seal(bytes, size, offsetof(bb_rays_header, checksum));
    }
    const char *path = fuzz_file("fuzz.rays", bytes, size);
    for (int by_hand = 0; by_hand < 2; by_hand++) {
        bb_rays *rays = NULL;
        bb_status status = bb_exchange_read_rays(path, scene, by_hand != 0, &rays);
        if (status == BB_OK)
            check_rays(scene, rays, by_hand != 0);
        else
            fuzz_refused(status);
        FUZZ_CHECK((status == BB_OK) == (rays != NULL));
        bb_rays_free(rays);
    }
    free(bytes);
    return 0;
}
