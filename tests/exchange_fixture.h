/* For tests of rays files and hits files: a scene, rays through it and the files of both, as bytes;
 * files that must be refused by a message that names them. */
#ifndef BB_TEST_EXCHANGE_FIXTURE_H
#define BB_TEST_EXCHANGE_FIXTURE_H

#include "framework/base/file.h"
#include "framework/judge/oracle.h"
#include "framework/workload/exchange_file.h"
#include "framework/workload/workload.h"
#include "tests/fixture.h"
#include "tests/hand_scene.h"
#include "tests/scene_files.h"

#include <errno.h> /* program_invocation_short_name */
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

static inline bb_rays *make_rays(const char *text, uint32_t count)
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
static inline size_t make_hits(char *bytes, uint32_t count, bool with_checksum)
{
    bb_hits_header header = {
        .version = BB_EXCHANGE_VERSION,
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
static inline void seal(char *bytes, size_t size, size_t checksum_at)
{
    memset(bytes + checksum_at, 0, 8);
    uint64_t sum = XXH3_64bits(bytes, size);
    memcpy(bytes + checksum_at, &sum, 8);
}

/* A message is one line that names the file. */
static inline void expect_message(const char *path, const char *words)
{
    if (strstr(bb_message(), words) == NULL || strstr(bb_message(), path) == NULL ||
        strchr(bb_message(), '\n') != NULL)
        fail_msg("'%s' lacks '%s' or the path", bb_message(), words);
}

/* A new file each time: to write into an old one may wait for the disk. */
static inline void write_anew(const char *path, const char *bytes, size_t size)
{
    unlink(path);
    write_bytes(path, bytes, size);
}

static inline bb_status read_rays(const char *bytes, size_t size, bb_rays **out)
{
    write_anew(rays_path, bytes, size);
    return bb_exchange_read_rays(rays_path, scene, false, out);
}

static inline bb_status read_hits(const char *bytes, size_t size, bb_outside_hits *out)
{
    *out = (bb_outside_hits){0};
    write_anew(hits_path, bytes, size);
    return bb_exchange_read_hits(hits_path, scene, rays, out);
}

static inline void refuses_rays(const char *bytes, size_t size, const char *words)
{
    bb_rays *got = NULL;
    bb_status status = read_rays(bytes, size, &got);
    if (status != BB_INVALID || got != NULL)
        fail_msg("a rays file that is wrong (%s) is read: status %d", words, (int)status);
    expect_message(rays_path, words);
}

static inline void refuses_hits(const char *bytes, size_t size, const char *words)
{
    bb_outside_hits got;
    bb_status status = read_hits(bytes, size, &got);
    if (status != BB_INVALID || got.hits != NULL || got.count != 0)
        fail_msg("a hits file that is wrong (%s) is read: status %d", words, (int)status);
    expect_message(hits_path, words);
}

static inline int set_up(void **state)
{
    (void)state;
    scene = hand_scene(2, 2);
    bb_random random = bb_random_make(3, 0);
    hand_random(scene, &random);
    if (bb_scene_finish(scene) != BB_OK)
        return -1;
    rays = make_rays("random", RAYS);
    rays_path = strdup(test_path(program_invocation_short_name, "a.rays"));
    hits_path = strdup(test_path(program_invocation_short_name, "a.hits"));
    char *data = NULL;
    if (bb_exchange_write_rays(rays_path, scene, rays, "a test") != BB_OK ||
        bb_file_read(rays_path, FILE_MAX, "test", &data, &rays_size) != BB_OK)
        return -1;
    memcpy(rays_bytes, data, rays_size);
    free(data);
    hits_size = make_hits(hits_bytes, RAYS, true);
    return 0;
}

static inline int tear_down(void **state)
{
    (void)state;
    bb_rays_free(rays);
    hand_free(scene);
    free(rays_path);
    free(hits_path);
    return 0;
}

#endif
