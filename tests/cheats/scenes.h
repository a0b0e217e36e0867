/* Scenes that no generator makes, as glTF files with everything in them. */
#ifndef CHEATS_SCENES_H
#define CHEATS_SCENES_H

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

static inline void write_base64(FILE *file, const unsigned char *bytes, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        unsigned group = 0;
        for (size_t k = 0; k < 3; k++)
            group = group << 8 | (i + k < size ? bytes[i + k] : 0u);
        for (size_t k = 0; k < 4; k++)
            fputc(i + k < size + 1 ? digits[group >> (18 - 6 * k) & 63] : '=', file);
    }
}

/* Nine coordinates per triangle. */
static inline void write_triangles(const char *path, const float *corners, uint32_t triangles)
{
    uint32_t vertices = 3 * triangles;
    float low[3] = {FLT_MAX, FLT_MAX, FLT_MAX}, high[3] = {-FLT_MAX, -FLT_MAX, -FLT_MAX};
    for (uint32_t i = 0; i < 3 * vertices; i++) {
        low[i % 3] = fminf(low[i % 3], corners[i]);
        high[i % 3] = fmaxf(high[i % 3], corners[i]);
    }
    size_t bytes = 3 * vertices * sizeof *corners;
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
                  "\"nodes\":[{\"mesh\":0}],"
                  "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],");
    fprintf(file,
            "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":%u,"
            "\"type\":\"VEC3\",\"min\":[%.9g,%.9g,%.9g],\"max\":[%.9g,%.9g,%.9g]}],",
            vertices, (double)low[0], (double)low[1], (double)low[2], (double)high[0],
            (double)high[1], (double)high[2]);
    fprintf(file,
            "\"bufferViews\":[{\"buffer\":0,\"byteLength\":%zu}],\"buffers\":[{\"byteLength\":%zu,"
            "\"uri\":\"data:application/octet-stream;base64,",
            bytes, bytes);
    write_base64(file, (const unsigned char *)corners, bytes);
    fputs("\"}]}\n", file);
    assert_int_equal(fclose(file), 0);
}

/* Its corners are at +-scale. */
static inline void write_tetrahedron(const char *path, float scale)
{
    static const float signs[4][3] = {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}};
    static const int faces[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
    float corners[36];
    for (int i = 0; i < 36; i++)
        corners[i] = scale * signs[faces[i / 9][i / 3 % 3]][i % 3];
    write_triangles(path, corners, 4);
}

/* Corner i, k of a grid of `rings` by 2 `rings` over the ball. */
static inline void ball_corner(int i, int k, int rings, float out[3])
{
    const double centre[3] = {0.1, 0.4, 0.05}, radius = 0.4, pi = 3.14159265358979323846;
    double theta = pi * i / rings, phi = pi * (k % (2 * rings)) / rings;
    out[0] = (float)(centre[0] + radius * sin(theta) * cos(phi));
    out[1] = (float)(centre[1] + radius * cos(theta));
    out[2] = (float)(centre[2] + radius * sin(theta) * sin(phi));
}

/* A ball of radius 0.4 on a ground of +-1e6; 2 + 224 triangles. */
static inline void write_ball_on_ground(const char *path)
{
    enum { RINGS = 8, MOST = 2 + 4 * RINGS * RINGS };
    static const float a = 1e6f;
    static float corners[MOST][9] = {{-a, 0, -a, a, 0, -a, a, 0, a},
                                     {-a, 0, -a, a, 0, a, -a, 0, a}};
    uint32_t count = 2;
    for (int i = 0; i < RINGS; i++)
        for (int k = 0; k < 2 * RINGS; k++)
            for (int half = 0; half < 2; half++) {
                if ((half == 0 && i == 0) || (half == 1 && i == RINGS - 1))
                    continue; /* of zero area, at a pole */
                float *c = corners[count++];
                ball_corner(half == 0 ? i : i + 1, half == 0 ? k : k + 1, RINGS, c);
                ball_corner(half == 0 ? i + 1 : i, half == 0 ? k : k + 1, RINGS, c + 3);
                ball_corner(half == 0 ? i : i + 1, half == 0 ? k + 1 : k, RINGS, c + 6);
            }
    write_triangles(path, &corners[0][0], count);
}

#endif
