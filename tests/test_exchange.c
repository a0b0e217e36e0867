/* Rays files and hits files: there and back, every kind of damage, and fuzzing: each truncation and
 * each damaged byte of a small file is refused or changes nothing. */
#include "framework/base/file.h"
#include "framework/exchange/exchange_file.h"
#include "framework/judge/oracle.h"
#include "framework/judge/queries.h"
#include "framework/workload/workload.h"
#include "tests/fixture.h"
#include "tests/hand_scene.h"
#include "tests/scene_files.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <xxhash.h>

enum { RAYS = 9, SEED = 5, FILE_MAX = 1 << 16 };

/* A scene of both kinds, rays through it, and the files of both. */
static bb_scene *scene;
static bb_rays *rays;
static char *rays_path, *hits_path;
static char rays_bytes[FILE_MAX], hits_bytes[FILE_MAX];
static size_t rays_size, hits_size;

static bb_rays *make_rays(const char *text, uint32_t count)
{
    bb_spec spec;
    bb_oracle *oracle = NULL;
    bb_rays *made = NULL;
    assert_int_equal(bb_spec_parse(text, &spec), BB_OK);
    assert_int_equal(bb_oracle_create(scene, 1, &oracle), BB_OK);
    bb_rays_request request = {
        .spec = &spec, .width = 4, .height = 4, .max_rays = count, .seed = SEED};
    if (bb_rays_make(scene, oracle, &request, &made) != BB_OK)
        fail_msg("%s: %s", text, bb_message());
    bb_oracle_destroy(oracle);
    return made;
}

/* A hits file as a tracer would write it: `count` hits, some of them misses. */
static size_t make_hits(char *bytes, uint32_t count, bool with_checksum)
{
    bb_hits_header header = {
        .version = 2,
        .byte_order = 0x01020304,
        .header_bytes = 128,
        .hit_count = count,
        .scene_hash = scene->hash,
        .rays_hash = rays->hash,
        .tracer = "test",
    };
    memcpy(header.magic, "BVHBHITS", 8);
    size_t size = sizeof header + count * sizeof(bb_hit);
    memcpy(bytes, &header, sizeof header);
    for (uint32_t i = 0; i < count; i++) {
        bb_hit hit = {0.25f + (float)i, i % scene->prim_count};
        if (i % 4 == 3)
            hit = (bb_hit){INFINITY, BB_NONE};
        memcpy(bytes + sizeof header + i * sizeof hit, &hit, sizeof hit);
    }
    if (with_checksum) {
        header.checksum = XXH3_64bits(bytes, size);
        memcpy(bytes, &header, sizeof header);
    }
    return size;
}

/* Makes the checksum right again, as a forger would. */
static void seal(char *bytes, size_t size, size_t checksum_at)
{
    memset(bytes + checksum_at, 0, 8);
    uint64_t sum = XXH3_64bits(bytes, size);
    memcpy(bytes + checksum_at, &sum, 8);
}

/* A message is one line that names the file. */
static void expect_message(const char *path, const char *words)
{
    if (strstr(bb_message(), words) == NULL || strstr(bb_message(), path) == NULL ||
        strchr(bb_message(), '\n') != NULL)
        fail_msg("'%s' lacks '%s' or the path", bb_message(), words);
}

/* A new file each time: to write into an old one may wait for the disk. */
static void write_anew(const char *path, const char *bytes, size_t size)
{
    unlink(path);
    write_bytes(path, bytes, size);
}

static bb_status read_rays(const char *bytes, size_t size, bb_rays **out)
{
    write_anew(rays_path, bytes, size);
    return bb_exchange_read_rays(rays_path, scene, false, out);
}

static bb_status read_hits(const char *bytes, size_t size, bb_outside_hits *out)
{
    *out = (bb_outside_hits){0};
    write_anew(hits_path, bytes, size);
    return bb_exchange_read_hits(hits_path, scene, rays, out);
}

static void refuses_rays(const char *bytes, size_t size, const char *words)
{
    bb_rays *got = NULL;
    bb_status status = read_rays(bytes, size, &got);
    if (status != BB_INVALID || got != NULL)
        fail_msg("a rays file that is wrong (%s) is read: status %d", words, (int)status);
    expect_message(rays_path, words);
}

static void refuses_hits(const char *bytes, size_t size, const char *words)
{
    bb_outside_hits got;
    bb_status status = read_hits(bytes, size, &got);
    if (status != BB_INVALID || got.hits != NULL || got.count != 0)
        fail_msg("a hits file that is wrong (%s) is read: status %d", words, (int)status);
    expect_message(hits_path, words);
}

/* ---- there and back ---- */

static void rays_come_back(void **state)
{
    (void)state;
    bb_rays *got = NULL;
    assert_int_equal(read_rays(rays_bytes, rays_size, &got), BB_OK);
    assert_string_equal(got->name, rays->name);
    assert_string_equal(got->view, rays->view);
    assert_ptr_equal(got->options, rays->options);
    assert_string_equal(got->spec.text, rays->spec.text);
    assert_int_equal(got->query, rays->query);
    assert_int_equal(got->count, rays->count);
    assert_int_equal(got->hash, rays->hash);
    assert_int_equal(got->must_hit, rays->must_hit);
    assert_int_equal(got->seed, rays->seed);
    assert_int_equal(got->primary_width, rays->primary_width);
    assert_int_equal(got->primary_height, rays->primary_height);
    assert_int_equal(got->max_rays, rays->max_rays);
    assert_memory_equal(got->rays, rays->rays, rays->count * sizeof(bb_ray));
    bb_rays_free(got);
}

/* By offsets, as one would read it in another language. */
static void the_file_is_what_the_header_says(void **state)
{
    (void)state;
    uint32_t words[6];
    uint64_t counts[4], hashes[3];
    memcpy(words, rays_bytes + 8, sizeof words);
    memcpy(counts, rays_bytes + 32, sizeof counts);
    memcpy(hashes, rays_bytes + 64, sizeof hashes);
    const uint32_t expected_words[] = {2, 0x01020304, 1024, 0, 1, 0};
    const uint64_t expected_counts[] = {RAYS, scene->vertex_count, 2, 2};
    assert_memory_equal(rays_bytes, "BVHBRAYS", 8);
    assert_memory_equal(words, expected_words, sizeof words);
    assert_memory_equal(counts, expected_counts, sizeof counts);
    uint64_t seed;
    uint32_t made_by[6]; /* picture, primary rays, the most rays, reserved */
    memcpy(&seed, rays_bytes + 88, sizeof seed);
    memcpy(made_by, rays_bytes + 96, sizeof made_by);
    const uint32_t expected_made_by[] = {0, 0, 4, 4, RAYS, 0};
    assert_int_equal(seed, SEED);
    assert_memory_equal(made_by, expected_made_by, sizeof made_by);
    assert_string_equal(rays_bytes + 120, scene->name);
    assert_string_equal(rays_bytes + 376, "random");
    assert_string_equal(rays_bytes + 504, "");
    assert_string_equal(rays_bytes + 552, "a test");
    const char *part = rays_bytes + 1024;
    assert_memory_equal(part, rays->rays, RAYS * sizeof(bb_ray));
    assert_int_equal(XXH3_64bits(part, RAYS * sizeof(bb_ray)), hashes[1]);
    part += RAYS * sizeof(bb_ray);
    assert_memory_equal(part, scene->vertices, scene->vertex_count * 12);
    part += scene->vertex_count * 12;
    assert_memory_equal(part, bb_scene_indices(scene), 2 * 12);
    part += 2 * 12;
    assert_memory_equal(part, bb_scene_floats(scene, BB_SPHERE), 2 * 16);
    part += 2 * 16;
    assert_int_equal(part - rays_bytes, rays_size);
    /* the scene's hash: three counts, then the three arrays */
    static char geometry[FILE_MAX];
    uint32_t few[3] = {scene->vertex_count, 2, 2};
    const char *begin = rays_bytes + 1024 + RAYS * sizeof(bb_ray);
    memcpy(geometry, few, sizeof few);
    memcpy(geometry + sizeof few, begin, (size_t)(part - begin));
    assert_int_equal(XXH3_64bits(geometry, sizeof few + (size_t)(part - begin)), hashes[0]);
    seal(rays_bytes, rays_size, 80);
    uint64_t sealed;
    memcpy(&sealed, rays_bytes + 80, 8);
    assert_int_equal(sealed, hashes[2]);
}

static void hits_come_back(void **state)
{
    (void)state;
    static char bytes[FILE_MAX];
    for (int checksum = 0; checksum < 2; checksum++)
        for (uint32_t count = 1; count <= RAYS; count++) {
            bb_outside_hits got;
            size_t size = make_hits(bytes, count, checksum != 0);
            if (read_hits(bytes, size, &got) != BB_OK)
                fail_msg("%s", bb_message());
            assert_int_equal(got.count, count);
            assert_string_equal(got.tracer, "test");
            assert_memory_equal(got.hits, bytes + 128, count * sizeof(bb_hit));
            bb_outside_hits_release(&got);
        }
}

/* ---- fuzzing ---- */

static void every_truncation_is_refused(void **state)
{
    (void)state;
    static char bytes[FILE_MAX];
    for (size_t size = 0; size < rays_size; size++)
        refuses_rays(rays_bytes, size, "bytes");
    for (size_t size = 0; size < hits_size; size++)
        refuses_hits(hits_bytes, size, "bytes");
    memcpy(bytes, rays_bytes, rays_size);
    refuses_rays(bytes, rays_size + 1, "too long");
    memcpy(bytes, hits_bytes, hits_size);
    refuses_hits(bytes, hits_size + 8, "too long");
}

static const unsigned char masks[] = {0x01, 0x10, 0x80, 0xFF};

static void every_damaged_byte_is_refused(void **state)
{
    (void)state;
    static char bytes[FILE_MAX];
    for (size_t m = 0; m < sizeof masks; m++) {
        memcpy(bytes, rays_bytes, rays_size);
        for (size_t i = 0; i < rays_size; i++) {
            bytes[i] = (char)(bytes[i] ^ masks[m]);
            refuses_rays(bytes, rays_size, "rays file");
            bytes[i] = rays_bytes[i];
        }
        memcpy(bytes, hits_bytes, hits_size);
        for (size_t i = 0; i < hits_size; i++) {
            bytes[i] = (char)(bytes[i] ^ masks[m]);
            refuses_hits(bytes, hits_size, "hits file");
            bytes[i] = hits_bytes[i];
        }
    }
}

/* Without a checksum a damaged header is refused all the same, its text apart; a damaged hit is
 * that one hit, or refused. */
static void damage_without_a_checksum_stays_where_it_is(void **state)
{
    (void)state;
    static char whole[FILE_MAX], bytes[FILE_MAX];
    size_t size = make_hits(whole, RAYS, false);
    uint32_t read = 0;
    for (size_t m = 0; m < sizeof masks; m++)
        for (size_t i = 0; i < size; i++) {
            memcpy(bytes, whole, size);
            bytes[i] = (char)(bytes[i] ^ masks[m]);
            bb_outside_hits got;
            if (read_hits(bytes, size, &got) != BB_OK) {
                expect_message(hits_path, "hits file");
                continue;
            }
            if (i < offsetof(bb_hits_header, tracer))
                fail_msg("byte %zu of the header can be damaged", i);
            assert_int_equal(got.count, RAYS);
            for (size_t k = 0; k < RAYS; k++)
                if (128 + 8 * k > i || 128 + 8 * k + 8 <= i)
                    assert_memory_equal(&got.hits[k], whole + 128 + 8 * k, 8);
            bb_outside_hits_release(&got);
            read++;
        }
    assert_true(read > 0);
}

static void noise_is_refused(void **state)
{
    (void)state;
    static char bytes[4096];
    bb_random random = bb_random_make(11, 0);
    for (int round = 0; round < 200; round++) {
        for (size_t i = 0; i < sizeof bytes; i++)
            bytes[i] = (char)bb_random_u64(&random);
        if (round % 2 == 1) { /* what is right at the front lets the reader go on */
            memcpy(bytes, round % 4 == 1 ? rays_bytes : hits_bytes, 20);
            refuses_rays(bytes, sizeof bytes, "rays file");
        }
        refuses_hits(bytes, sizeof bytes, "hits file");
    }
}

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
        {IN_RAYS(version), U32(1),
         "version 1, this program reads 2 and 3: make rays and hits anew"},
        {IN_RAYS(version), U32(3), "version 3, so more_counts must have one that is not 0"},
        {IN_RAYS(version), U32(4), "version 4"},
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
        {IN_RAYS(generator) + 471, "x", 1, "generator is no text"},
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
        {IN_HITS(version), U32(1), "version 1, this program reads 2: make rays and hits anew"},
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

/* ---- files ---- */

static void odd_files_are_refused(void **state)
{
    (void)state;
    bb_rays *got = NULL;
    bb_outside_hits hits = {0};
    const char *fifo = test_path("exchange", "fifo");
    unlink(fifo);
    assert_int_equal(mkfifo(fifo, 0600), 0);
    const char *const paths[] = {test_path("exchange", "missing"), "/", "/dev/zero", fifo};
    for (size_t i = 0; i < sizeof paths / sizeof paths[0]; i++) {
        assert_int_equal(bb_exchange_read_rays(paths[i], scene, false, &got), BB_INVALID);
        expect_message(paths[i], "rays file");
        assert_int_equal(bb_exchange_read_hits(paths[i], scene, rays, &hits), BB_INVALID);
        expect_message(paths[i], "hits file");
    }
    /* a giant without content is refused before any memory is taken for it */
    const char *giant = test_path("exchange", "giant");
    write_bytes(giant, rays_bytes, rays_size);
    assert_int_equal(truncate(giant, (off_t)1 << 40), 0);
    assert_int_equal(bb_exchange_read_rays(giant, scene, false, &got), BB_INVALID);
    expect_message(giant, "too long");
    unlink(giant);
    assert_int_equal(bb_exchange_write_rays("/dev/null", scene, rays, "test"), BB_INVALID);
    assert_int_equal(bb_exchange_write_rays("/no/such/folder/x", scene, rays, "test"), BB_INVALID);
}

static void long_generators_are_cut(void **state)
{
    (void)state;
    char text[2000];
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    bb_rays *got = NULL;
    assert_int_equal(bb_exchange_write_rays(rays_path, scene, rays, text), BB_OK);
    if (bb_exchange_read_rays(rays_path, scene, false, &got) != BB_OK)
        fail_msg("%s", bb_message());
    bb_rays_free(got);
}

static int set_up(void **state)
{
    (void)state;
    scene = hand_scene(2, 2);
    bb_random random = bb_random_make(3, 0);
    hand_random(scene, &random);
    if (bb_scene_finish(scene) != BB_OK)
        return -1;
    rays = make_rays("random", RAYS);
    rays_path = strdup(test_path("exchange", "a.rays"));
    hits_path = strdup(test_path("exchange", "a.hits"));
    char *data = NULL;
    if (bb_exchange_write_rays(rays_path, scene, rays, "a test") != BB_OK ||
        bb_file_read(rays_path, FILE_MAX, "test", &data, &rays_size) != BB_OK)
        return -1;
    memcpy(rays_bytes, data, rays_size);
    free(data);
    hits_size = make_hits(hits_bytes, RAYS, true);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    bb_rays_free(rays);
    hand_free(scene);
    free(rays_path);
    free(hits_path);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_come_back),
        cmocka_unit_test(the_file_is_what_the_header_says),
        cmocka_unit_test(hits_come_back),
        cmocka_unit_test(every_truncation_is_refused),
        cmocka_unit_test(every_damaged_byte_is_refused),
        cmocka_unit_test(damage_without_a_checksum_stays_where_it_is),
        cmocka_unit_test(noise_is_refused),
        cmocka_unit_test(forged_rays_are_refused),
        cmocka_unit_test(rays_that_are_none_are_refused),
        cmocka_unit_test(forged_rays_are_not_those_of_their_workload),
        cmocka_unit_test(rays_made_by_hand_have_a_name_of_their_own),
        cmocka_unit_test(sealed_noise_is_refused_or_can_be_traced),
        cmocka_unit_test(forged_hits_are_refused),
        cmocka_unit_test(odd_answers_are_read),
        cmocka_unit_test(odd_files_are_refused),
        cmocka_unit_test(long_generators_are_cut),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
