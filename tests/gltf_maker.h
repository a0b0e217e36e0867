/* Small glTF files for tests: data are added, each gets an accessor, and members are written
 * around them. */
#ifndef BB_GLTF_MAKER_H
#define BB_GLTF_MAKER_H

#include "tests/scene_files.h"

typedef struct maker {
    unsigned char bytes[1 << 13];
    char views[1 << 13], accessors[1 << 13];
    size_t size;
    int count; /* of accessors */
} maker;

/* An accessor of `members` without a comma at the end, and its bytes; returns its number. */
static inline int add_bytes(maker *m, const void *bytes, size_t size, const char *members)
{
    size_t views = strlen(m->views), accessors = strlen(m->accessors);
    const char *comma = m->count > 0 ? "," : "";
    assert_true(m->size + size + 4 <= sizeof m->bytes);
    memcpy(m->bytes + m->size, bytes, size);
    snprintf(m->views + views, sizeof m->views - views,
             "%s{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu}", comma, m->size, size);
    snprintf(m->accessors + accessors, sizeof m->accessors - accessors, "%s{\"bufferView\":%d,%s}",
             comma, m->count, members);
    m->size += (size + 3) / 4 * 4;
    return m->count++;
}

/* `numbers` per element: 1, 3, 4 or 16. */
static inline int add_floats(maker *m, int count, int numbers, const float *values)
{
    char members[128];
    const char *type = numbers == 1   ? "SCALAR"
                       : numbers == 3 ? "VEC3"
                       : numbers == 4 ? "VEC4"
                                      : "MAT4";
    snprintf(members, sizeof members, "\"componentType\":5126,\"count\":%d,\"type\":\"%s\"", count,
             type);
    return add_bytes(m, values, (size_t)(count * numbers) * sizeof(float), members);
}

/* The file `name` in this test's folder, of the data and of `members`, which are the document's and
 * begin without a comma. Returns its path. */
static inline const char *write_made(const maker *m, const char *test, const char *name,
                                     const char *members)
{
    static char text[1 << 15];
    char binary[128];
    snprintf(binary, sizeof binary, "%s.bin", name);
    write_bytes(test_path(test, binary), m->bytes, m->size);
    int length = snprintf(text, sizeof text,
                          "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":%zu,"
                          "\"uri\":\"%s\"}],\"bufferViews\":[%s],\"accessors\":[%s],%s}",
                          m->size, binary, m->views, m->accessors, members);
    assert_true(length > 0 && (size_t)length < sizeof text);
    const char *path = test_path(test, name);
    write_text(path, text);
    return path;
}

/* Brings the scene to a frame and gives a vertex. */
static inline const float *vertex_at(bb_scene *scene, uint32_t frame, uint32_t vertex)
{
    ASSERT_OK(bb_scene_set_frame(scene, frame, NULL));
    return scene->vertices + 3 * (size_t)vertex;
}

static inline void expect_vertex(bb_scene *scene, uint32_t frame, uint32_t vertex, double x,
                                 double y, double z, double slack)
{
    const float *p = vertex_at(scene, frame, vertex);
    const double expected[] = {x, y, z};
    for (int axis = 0; axis < 3; axis++)
        if (!((double)p[axis] >= expected[axis] - slack &&
              (double)p[axis] <= expected[axis] + slack))
            fail_msg("frame %u, vertex %u: (%.9g %.9g %.9g) instead of (%.9g %.9g %.9g)", frame,
                     vertex, (double)p[0], (double)p[1], (double)p[2], x, y, z);
}

#endif
