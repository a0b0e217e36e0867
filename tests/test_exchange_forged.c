/* Rays files and hits files that were forged, so that all checksums are right: each rule by itself,
 * rays that the header's workload does not make, noise; and answers that are odd, but right. */
#include "framework/judge/queries.h"
#include "tests/exchange_fixture.h"

/* ---- damage with a right checksum: each rule of its own ---- */

typedef struct damage {
    size_t at;
    const void *value;
    size_t size;
    const char *words;
} damage;

#define U32(...) &(uint32_t){__VA_ARGS__}, 4
#define U64(...) &(uint64_t){__VA_ARGS__}, 8
#define F32(...) &(float){__VA_ARGS__}, 4
#define IN_RAYS(member) offsetof(bb_rays_header, member)
#define IN_HITS(member) offsetof(bb_hits_header, member)

static void forged_rays_are_refused(void **state)
{
    (void)state;
    static char bytes[FILE_MAX];
    const size_t geometry = 1024 + RAYS * sizeof(bb_ray);
    const damage damages[] = {
        {0, "BVHBHITS", 8, "BVHBRAYS"},
        {0, "\x89PNG\r\n\x1a\n", 8, "BVHBRAYS"},
        {IN_RAYS(version), U32(0), "version 0"},
        {IN_RAYS(version), U32(1), "version 1, this program reads 4: make rays and hits anew"},
        {IN_RAYS(version), U32(3), "version 3"},
        {IN_RAYS(byte_order), U32(0x04030201), "little-endian"},
        {IN_RAYS(header_bytes), U32(1028), "1028"},
        {IN_RAYS(query), U32(2), "query"},
        {IN_RAYS(query), U32(1), "no rays 'random' for this query"},
        {IN_RAYS(interval), U32(0), "interval"},
        {IN_RAYS(must_hit), U32(2), "must_hit is 2, must be 0 or 1"},
        {IN_RAYS(must_hit), U32(1), "must_hit is 1, for rays 'random' it is 0"},
        {IN_RAYS(rays), "edges:from=inside", 18,
         "must_hit is 0, for rays 'edges:from=inside' it is 1"},
        {IN_RAYS(reserved), U32(1), "reserved"},
        {IN_RAYS(max_rays), U32(UINT32_MAX), "max_rays"},
        {IN_RAYS(ray_count), U64(0), "no ray"},
        {IN_RAYS(ray_count), U64(RAYS + 1), "truncated"},
        {IN_RAYS(ray_count), U64(RAYS - 1), "too long"},
        {IN_RAYS(ray_count), U64(UINT64_MAX), "ray_count"},
        {IN_RAYS(ray_count), U64((UINT64_C(1) << 59) + RAYS), "ray_count"},
        {IN_RAYS(ray_count), U64(INT32_MAX), "truncated"},
        {IN_RAYS(vertex_count), U64(UINT64_MAX / 12 + 1), "vertex_count"},
        {IN_RAYS(vertex_count), U64(UINT32_MAX), "truncated"},
        {IN_RAYS(triangle_count), U64(UINT64_C(1) << 62), "triangle_count"},
        {IN_RAYS(sphere_count), U64(UINT64_C(1) << 60), "sphere_count"},
        {IN_RAYS(scene_hash), U64(1), "another scene"},
        {IN_RAYS(rays_hash), U64(1), "its rays have hash"},
        {IN_RAYS(width), U32(3), "picture of 3x0"},
        {IN_RAYS(width), &(uint32_t[]){65536, 65536}, 8, "picture of 65536x65536"},
        {IN_RAYS(scene), "two\nlines", 10, "scene is no text"},
        {IN_RAYS(scene) + 255, "x", 1, "scene is no text"},
        {IN_RAYS(view), "\x1b[2J", 5, "view is no text"},
        {IN_RAYS(generator) + 423, "x", 1, "generator is no text"},
        {IN_RAYS(rays), "gamma", 6, "no rays 'gamma'"},
        {IN_RAYS(rays), "mine\0", 6, "made by hand need --verify no"},
        {IN_RAYS(rays), "random:speed=3", 15, "'speed'"},
        {geometry, F32(0.125f), "primitives"},
    };
    for (size_t i = 0; i < sizeof damages / sizeof damages[0]; i++) {
        const damage *d = &damages[i];
        memcpy(bytes, rays_bytes, rays_size);
        memcpy(bytes + d->at, d->value, d->size);
        seal(bytes, rays_size, IN_RAYS(checksum));
        refuses_rays(bytes, rays_size, d->words);
    }
}

/* Rays that nobody can trace, with all hashes right. */
static void rays_that_are_none_are_refused(void **state)
{
    (void)state;
    static char bytes[FILE_MAX];
    static const float values[] = {NAN, INFINITY, -INFINITY};
    for (size_t k = 0; k < 7; k++) /* tmax may be infinite */
        for (size_t v = 0; v < 3; v++) {
            memcpy(bytes, rays_bytes, rays_size);
            memcpy(bytes + 1024 + 3 * sizeof(bb_ray) + 4 * k, &values[v], 4);
            uint64_t hash = XXH3_64bits(bytes + 1024, RAYS * sizeof(bb_ray));
            memcpy(bytes + IN_RAYS(rays_hash), &hash, 8);
            seal(bytes, rays_size, IN_RAYS(checksum));
            bb_rays *got = NULL;
            assert_int_equal(read_rays(bytes, rays_size, &got), BB_INVALID);
            assert_null(got);
            expect_message(rays_path, "ray 3");
        }
}

/* ---- rays that the header's workload does not make ---- */

static void write_header(char *bytes, size_t at, const void *value, size_t size)
{
    memcpy(bytes, rays_bytes, rays_size);
    memcpy(bytes + at, value, size);
    uint64_t hash = XXH3_64bits(bytes + 1024, RAYS * sizeof(bb_ray));
    memcpy(bytes + IN_RAYS(rays_hash), &hash, 8);
    seal(bytes, rays_size, IN_RAYS(checksum));
}

/* Read well, since all hashes are right; found out when they are made again. */
static void forged_rays_are_not_those_of_their_workload(void **state)
{
    (void)state;
    static char bytes[FILE_MAX];
    const size_t ray = 1024 + 3 * sizeof(bb_ray);
    const damage damages[] = {
        {ray, F32(0.125f), "are not those of 'random'"},
        {ray + 28, F32(1e30f), "are not those of 'random'"}, /* tmax */
        {IN_RAYS(seed), U64(SEED + 1), "are not those of 'random'"},
        {IN_RAYS(max_rays), U32(RAYS - 1), "are not those of 'random', which are 8"},
        {IN_RAYS(max_rays), U32(RAYS + 1), "are not those of 'random', which are 10"},
        {IN_RAYS(max_rays), U32(0), "cannot be made again"},
        {IN_RAYS(width), &(uint32_t[]){3, 3}, 8, "are not those of 'random'"},
        {IN_RAYS(primary_width), U32(0), "1 to "},
        {IN_RAYS(primary_width), &(uint32_t[]){65536, 65536}, 8, "1 to "},
        {IN_RAYS(rays), "random:tmin=1", 14, "are not those of 'random:tmin=1'"},
        {IN_RAYS(rays), "diffuse", 8, "cannot be made again"},
        {IN_RAYS(rays), "primary", 8, "cannot be made again: rays primary: need a view"},
        {IN_RAYS(view), "behind", 7, "no view 'behind'"},
    };
    bb_oracle *oracle = NULL;
    assert_int_equal(bb_oracle_create(scene, 1, &oracle), BB_OK);
    for (size_t i = 0; i < sizeof damages / sizeof damages[0]; i++) {
        bb_rays *got = NULL;
        write_header(bytes, damages[i].at, damages[i].value, damages[i].size);
        if (read_rays(bytes, rays_size, &got) != BB_OK)
            fail_msg("damage %zu: %s", i, bb_message());
        assert_int_equal(bb_exchange_verify_rays(rays_path, scene, oracle, got), BB_INVALID);
        expect_message(rays_path, damages[i].words);
        bb_rays_free(got);
    }
    bb_rays *got = NULL;
    assert_int_equal(read_rays(rays_bytes, rays_size, &got), BB_OK);
    if (bb_exchange_verify_rays(rays_path, scene, oracle, got) != BB_OK)
        fail_msg("%s", bb_message());
    bb_rays_free(got);
    bb_oracle_destroy(oracle);
}

static void rays_made_by_hand_have_a_name_of_their_own(void **state)
{
    (void)state;
    static char bytes[FILE_MAX], named[FILE_MAX];
    static const char none[24]; /* of all that rays of a workload are made by */
    bb_rays *got = NULL;
    write_header(bytes, IN_RAYS(rays), "mine:by=me", 11);
    memcpy(bytes + IN_RAYS(seed), none, 8);
    memcpy(bytes + IN_RAYS(primary_width), none, 12);
    memcpy(bytes + 1024, F32(0.125f));
    uint64_t hash = XXH3_64bits(bytes + 1024, RAYS * sizeof(bb_ray));
    memcpy(bytes + IN_RAYS(rays_hash), &hash, 8);
    seal(bytes, rays_size, IN_RAYS(checksum));
    refuses_rays(bytes, rays_size, "no rays 'mine' for this query");
    if (bb_exchange_read_rays(rays_path, scene, true, &got) != BB_OK)
        fail_msg("%s", bb_message());
    assert_null(got->options);
    assert_string_equal(got->name, "mine:by=me");
    assert_int_equal(got->query, &bb_query_closest);
    assert_false(got->must_hit);
    bb_rays_free(got);

    const damage damages[] = {
        {IN_RAYS(rays), "primary\0\0\0", 11, "'primary' names a workload"},
        {IN_RAYS(rays), "edges:count=9", 14, "'edges' names a workload"},
        {IN_RAYS(must_hit), U32(1), "must be 0"},
        {IN_RAYS(seed), U64(1), "must be 0"},
        {IN_RAYS(primary_width), U32(4), "must be 0"},
        {IN_RAYS(primary_height), U32(4), "must be 0"},
        {IN_RAYS(max_rays), U32(RAYS), "must be 0"},
    };
    for (size_t i = 0; i < sizeof damages / sizeof damages[0]; i++) {
        memcpy(named, bytes, rays_size);
        memcpy(named + damages[i].at, damages[i].value, damages[i].size);
        seal(named, rays_size, IN_RAYS(checksum));
        write_anew(rays_path, named, rays_size);
        assert_int_equal(bb_exchange_read_rays(rays_path, scene, true, &got), BB_INVALID);
        assert_null(got);
        expect_message(rays_path, damages[i].words);
    }
}

/* Some bytes at random, with all hashes right: what is read then can be traced. */
static void sealed_noise_is_refused_or_can_be_traced(void **state)
{
    (void)state;
    static char bytes[FILE_MAX];
    bb_random random = bb_random_make(12, 0);
    uint32_t read = 0;
    for (int round = 0; round < 3000; round++) {
        memcpy(bytes, rays_bytes, rays_size);
        for (uint32_t k = 0; k <= bb_random_below(&random, 3); k++) {
            bool in_rays = bb_random_below(&random, 2) == 1;
            size_t at = in_rays ? 1024 + bb_random_below(&random, RAYS * sizeof(bb_ray))
                                : bb_random_below(&random, (uint32_t)rays_size);
            bytes[at] = (char)bb_random_u64(&random);
        }
        uint64_t hash = XXH3_64bits(bytes + 1024, RAYS * sizeof(bb_ray));
        memcpy(bytes + IN_RAYS(rays_hash), &hash, 8);
        seal(bytes, rays_size, IN_RAYS(checksum));
        bb_rays *got = NULL;
        bb_status status = read_rays(bytes, rays_size, &got);
        if (status == BB_OK) {
            assert_int_equal(got->count, RAYS);
            assert_int_equal(bb_rays_check(scene, got), BB_OK);
            read++;
        } else {
            assert_int_equal(status, BB_INVALID);
            expect_message(rays_path, "rays file");
        }
        bb_rays_free(got);
    }
    assert_true(read > 100 && read < 2900);
}

static void forged_hits_are_refused(void **state)
{
    (void)state;
    static char bytes[FILE_MAX];
    const size_t hit = 128 + 2 * sizeof(bb_hit);
    const damage damages[] = {
        {0, "BVHBRAYS", 8, "BVHBHITS"},
        {IN_HITS(version), U32(1), "version 1, this program reads 4: make rays and hits anew"},
        {IN_HITS(version), U32(7), "version 7"},
        {IN_HITS(byte_order), U32(0x04030201), "little-endian"},
        {IN_HITS(header_bytes), U32(0), "header of 0"},
        {IN_HITS(reserved), U32(1), "reserved"},
        {IN_HITS(hit_count), U64(0), "no hit"},
        {IN_HITS(hit_count), U64(RAYS - 1), "too long"},
        {IN_HITS(hit_count), U64(RAYS + 1), "10 hits for 9 rays"},
        {IN_HITS(hit_count), U64((UINT64_C(1) << 61) + RAYS), "hits for 9 rays"},
        {IN_HITS(scene_hash), U64(3), "other rays"},
        {IN_HITS(rays_hash), U64(3), "other rays"},
        {IN_HITS(tracer), "bell\a", 6, "tracer is no text"},
        {IN_HITS(tracer) + 71, "x", 1, "tracer is no text"},
        {hit, F32(NAN), "t = nan, primitive 2 is no answer to ray 2"},
        {hit, F32(INFINITY), "t = inf, primitive 2 is no answer to ray 2"},
        {hit, F32(-INFINITY), "no answer to ray 2"},
        {hit + 4, U32(4), "primitive 4 is no answer to ray 2"},
        {hit + 4, U32(BB_NONE), "no answer to ray 2"},    /* a miss with a t */
        {hit + 4, U32(BB_UNNAMED), "no answer to ray 2"}, /* of a closest hit */
        {hit, &(uint32_t[]){BB_POISON, BB_POISON}, 8, "no answer to ray 2"},
        {hit, &(bb_hit){-INFINITY, BB_NONE}, 8, "no answer to ray 2"},
        {hit, &(bb_hit){NAN, BB_NONE}, 8, "no answer to ray 2"},
    };
    for (size_t i = 0; i < sizeof damages / sizeof damages[0]; i++) {
        const damage *d = &damages[i];
        memcpy(bytes, hits_bytes, hits_size);
        memcpy(bytes + d->at, d->value, d->size);
        seal(bytes, hits_size, IN_HITS(checksum));
        refuses_hits(bytes, hits_size, d->words);
    }
    /* a whole hit more than there are rays */
    size_t size = make_hits(bytes, RAYS + 1, true);
    refuses_hits(bytes, size, "10 hits for 9 rays");
}

/* What one may think is refused, and is an answer. */
static void odd_answers_are_read(void **state)
{
    (void)state;
    static char bytes[FILE_MAX];
    static const bb_hit odd[] = {{-1, 0}, {0, 3}, {3e38f, 1}, {1e-45f, 2}, {INFINITY, BB_NONE}};
    size_t size = make_hits(bytes, 5, false);
    memcpy(bytes + 128, odd, sizeof odd);
    bb_outside_hits got;
    assert_int_equal(read_hits(bytes, size, &got), BB_OK);
    assert_memory_equal(got.hits, odd, sizeof odd);
    bb_outside_hits_release(&got);

    const bb_query *query = rays->query;
    rays->query = &bb_query_any;
    static const bb_hit unnamed[] = {{0, BB_UNNAMED}, {NAN, BB_UNNAMED}};
    memcpy(bytes + 128, unnamed, sizeof unnamed);
    bb_status status = read_hits(bytes, size, &got);
    rays->query = query;
    assert_int_equal(status, BB_OK);
    bb_outside_hits_release(&got);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forged_rays_are_refused),
        cmocka_unit_test(rays_that_are_none_are_refused),
        cmocka_unit_test(forged_rays_are_not_those_of_their_workload),
        cmocka_unit_test(rays_made_by_hand_have_a_name_of_their_own),
        cmocka_unit_test(sealed_noise_is_refused_or_can_be_traced),
        cmocka_unit_test(forged_hits_are_refused),
        cmocka_unit_test(odd_answers_are_read),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
