/* The box test and the triangle test together: whatever the triangle test accepts is in the
 * triangle's own box, at the distance that it computes (kernels/ERROR_BUDGET.md), also with
 * quotients that are off by 2.5 ulp; and the constants of that budget are not much too large. Then
 * whole walls, seen along long triangles, by every kernel. Seed: BVHBENCH_TEST_SEED. */
#include "framework/base/random.h"
#include "framework/judge/queries.h"
#include "tests/device_fixture.h"
#include "tests/trace_fixture.h"

/* ---- on the device: triangle i against ray i, and its own box ---- */

static const char *const prologue[] = {
    "",
    /* up to two floats off what is rounded rightly, by chance */
    "float __attribute__((overloadable)) off(float q)\n"
    "{\n"
    "    uint bits = as_uint(q), hash = (bits ^ bits >> 15) * 0x2C1B3C6Du;\n"
    "    hash = (hash ^ hash >> 12) * 0x297A2D39u;\n"
    "    bool usable = fabs(q) > 0.0f && fabs(q) < FLT_MAX;\n"
    "    return usable ? as_float(bits + (hash >> 15) % 5u - 2u) : q;\n"
    "}\n"
    "float2 __attribute__((overloadable)) off(float2 q)\n"
    "{\n"
    "    return (float2)(off(q.x), off(q.y));\n"
    "}\n"
    "float4 __attribute__((overloadable)) off(float4 q)\n"
    "{\n"
    "    return (float4)(off(q.lo), off(q.hi));\n"
    "}\n"
    "#define BB_DIVIDE(a, b) off((a) / (b))\n",
};

static const char program_text[] =
    "#include \"bb_device.h\"\n"
    "#include \"intersect.clh\"\n"
    "#if BB_COMPRESSED\n"
    "#include \"cwbvh.clh\"\n"
    "#include \"wide_boxes.clh\"\n"
    /* in a compressed node: the box, at any place, beside one that makes the node up to 254 steps
     * wide, and such that the box begins or ends on a step but for its padding */
    "bool meets(const bb_slab *slab, const float *box, uint i, float t, global bb_cwbvh *node)\n"
    "{\n"
    "    uint hash = i * 0x9E3779B9u, place = hash >> 29, inner;\n"
    "    uint2 base;\n"
    "    bb_wide_boxes boxes;\n"
    "    bb_wide_clear(&boxes);\n"
    "    boxes.places = 1u << place | 1u << (place ^ 1u);\n"
    "    float longest = bb_longest_side(box, box + 4);\n"
    "    float step = as_float((as_uint(longest) & 0x7F800000u) + ((hash & 15u) << 23));\n"
    "    float from = step * (float)(hash >> 8 & 127u), most = step * 254.0f;\n"
    "    for (uint k = 0; k < 3; k++) {\n"
    "        float lo = box[k], hi = box[4 + k], other;\n"
    "        float pad = BB_PAD_BOX * longest;\n"
    "        other = (hash & 16u) != 0u ? lo + pad - from : hi - pad + from - most;\n"
    "        boxes.planes[16u * k + place] = lo;\n"
    "        boxes.planes[16u * k + 8u + place] = hi;\n"
    "        boxes.planes[16u * k + (place ^ 1u)] = other;\n"
    "        boxes.planes[16u * k + 8u + (place ^ 1u)] = other + most;\n"
    "    }\n"
    "    bb_wide_write(&boxes, node);\n"
    "    for (uint c = 0; c < 8; c++)\n"
    "        node->meta[c] = 1u << 5 | c;\n"
    "    return (bb_cwbvh_meet(slab, node, 0u, t, t, &inner, &base) >> place & 1u) != 0u;\n"
    "}\n"
    "#endif\n"
    "kernel void test(global const float *vertices, global const uint *indices,\n"
    "                 global const bb_ray *rays, uint count, float scale, global uint *records,\n"
    "                 global float *found, global bb_cwbvh *nodes)\n"
    "{\n"
    "    uint i = get_global_id(0);\n"
    "    if (i >= count)\n"
    "        return;\n"
    "    global uint *record = records + i * BB_WORDS;\n"
    "    bb_triangle_write(record, 1, BB_FORMAT_VERTICES, indices + 3 * i, vertices, scale);\n"
    "    float node[8];\n"
    "    for (uint k = 0; k < 3; k++) {\n"
    "        float a = vertices[9 * i + k], b = vertices[9 * i + 3 + k],\n"
    "              c = vertices[9 * i + 6 + k];\n"
    "        node[k] = BB_MIN(a, BB_MIN(b, c));\n"
    "        node[4 + k] = BB_MAX(a, BB_MAX(b, c));\n"
    "    }\n"
    "    bb_scale_and_pad(node, node + 4, scale, -1.0f);\n"
    "    for (uint k = 0; k < 8; k++)\n"
    "        found[10 * i + 2 + k] = node[k];\n"
    "    bb_ray_setup setup;\n"
    "    bb_ray_setup_make(&setup, rays + i, scale);\n"
    "    bb_slab slab = bb_slab_of(setup.o, setup.d);\n"
    "    float t = bb_triangle(&setup, (global const float *)record);\n"
    "    found[10 * i] = t;\n"
    "#if BB_COMPRESSED\n"
    "    found[10 * i + 1] = meets(&slab, node, i, t, nodes + i);\n"
    "#else\n"
    "    found[10 * i + 1] = bb_meets_node(&slab, found + 10 * i + 2, t, t);\n"
    "#endif\n"
    "}\n";

typedef struct batch {
    uint32_t count;
    float *vertices; /* 9 per case */
    bb_ray *rays;
} batch;

static void upload(bb_buffer *buffer, const void *data, size_t bytes)
{
    *buffer = (bb_buffer){0};
    check(bb_buffer_reserve(device, NULL, bytes, "test", buffer), "buffer");
    if (data != NULL)
        check(bb_buffer_write(buffer, 0, bytes, data), "buffer");
}

typedef struct verdict {
    uint32_t accepted; /* by the triangle test */
    uint32_t lost;     /* accepted, and the box not met at that distance */
    uint32_t first;    /* of those */
} verdict;

static verdict run(const batch *b, float scale, bool rough, const char *defines)
{
    char *text = malloc(strlen(prologue[rough]) + sizeof program_text);
    strcpy(text, prologue[rough]);
    strcat(text, program_text);
    const bb_source source = {.name = "test_watertight.cl", .text = text};
    uint32_t *order = calloc(3 * (size_t)b->count, sizeof *order);
    float *found = calloc(10 * (size_t)b->count, sizeof *found);
    for (uint32_t i = 0; i < 3 * b->count; i++)
        order[i] = i;
    bb_buffer vertices, indices, rays, records, d_found, nodes;
    const bool compressed = strstr(defines, "BB_COMPRESSED") != NULL;
    upload(&vertices, b->vertices, 9 * (size_t)b->count * sizeof(float));
    upload(&indices, order, 3 * (size_t)b->count * sizeof *order);
    upload(&rays, b->rays, b->count * sizeof *b->rays);
    upload(&records, NULL,
           (size_t)b->count * bb_leaf_prim_words(BB_TRIANGLES, BB_FORMAT_VERTICES) * sizeof(float));
    upload(&d_found, NULL, 10 * (size_t)b->count * sizeof *found);
    upload(&nodes, NULL, (compressed ? (size_t)b->count : 1) * sizeof(bb_cwbvh));
    cl_program program;
    cl_kernel kernel;
    check(bb_program_build(device, &source, defines, &program), "program");
    check(bb_kernel_get(program, "test", &kernel), "kernel");
    check(bb_launch(device, kernel, b->count, 64, BB_MEM(vertices), BB_MEM(indices), BB_MEM(rays),
                    BB_VALUE(b->count), BB_VALUE(scale), BB_MEM(records), BB_MEM(d_found),
                    BB_MEM(nodes)),
          "launch");
    check(bb_buffer_read(&d_found, 0, 10 * (size_t)b->count * sizeof *found, found), "read");
    verdict v = {0, 0, 0};
    for (uint32_t i = 0; i < b->count; i++) {
        float t = found[10 * (size_t)i];
        if (!(t > 0 && t < INFINITY))
            continue;
        v.accepted++;
        if (found[10 * (size_t)i + 1] != 0)
            continue;
        v.first = v.lost == 0 ? i : v.first;
        v.lost++;
    }
    bb_kernel_release(kernel);
    bb_program_release(program);
    bb_programs_clear(device); /* the cache knows sources by address */
    bb_buffer_release(&vertices);
    bb_buffer_release(&indices);
    bb_buffer_release(&rays);
    bb_buffer_release(&records);
    bb_buffer_release(&d_found);
    bb_buffer_release(&nodes);
    free(order);
    free(found);
    free(text);
    return v;
}

/* ---- cases ---- */

/* A random rotation, or one of the axes' own. */
static void make_frame(bb_random *random, double frame[3][3])
{
    bool aligned = bb_random_below(random, 2) == 0;
    int axis = (int)bb_random_below(random, 3);
    for (int k = 0; k < 3; k++) {
        frame[0][k] = aligned ? k == axis : bb_random_range(random, -1, 1);
        frame[1][k] = aligned ? k == (axis + 1) % 3 : bb_random_range(random, -1, 1);
    }
    double length = hypot(hypot(frame[0][0], frame[0][1]), frame[0][2]), along = 0;
    for (int k = 0; k < 3; k++)
        along += (frame[0][k] /= length) * frame[1][k];
    for (int k = 0; k < 3; k++)
        frame[1][k] -= along * frame[0][k];
    length = hypot(hypot(frame[1][0], frame[1][1]), frame[1][2]);
    for (int k = 0; k < 3; k++)
        frame[1][k] /= length;
    for (int k = 0; k < 3; k++)
        frame[2][k] = frame[0][(k + 1) % 3] * frame[1][(k + 2) % 3] -
                      frame[0][(k + 2) % 3] * frame[1][(k + 1) % 3];
}

/* A long triangle in the plane z = 1 of the frame, one of whose edges runs along its x; the ray
 * starts near the origin of the frame and is aimed near that edge, or at any place of the triangle.
 * Then all of it is moved and scaled. */
static void make_case(bb_random *random, float *vertices, bb_ray *ray)
{
    double frame[3][3], move[3], scale = ldexp(1, (int)bb_random_below(random, 61) - 30);
    make_frame(random, frame);
    double reach = pow(10, bb_random_range(random, -1, 6)),
           width = pow(10, bb_random_range(random, -3, 3));
    double back = bb_random_below(random, 3) == 0 ? 0.5 : reach * bb_random_range(random, -1, 1);
    double corners[3][3] = {{back - reach, 0, 1}, {back + reach, 0, 1}, {0, width, 1}};
    corners[2][0] = back + reach * bb_random_range(random, -1, 1);
    if (bb_random_below(random, 4) == 0)
        corners[2][2] += bb_random_range(random, -1, 1);
    double far = bb_random_below(random, 4) == 0 ? pow(10, bb_random_range(random, 0, 6)) : 0;
    for (int k = 0; k < 3; k++)
        move[k] = far * bb_random_range(random, -1, 1);
    double from[3], at[3];
    for (int k = 0; k < 3; k++)
        from[k] = 0.1 * bb_random_range(random, -1, 1);
    double s = bb_random_unit(random), step = pow(10, bb_random_range(random, -2, 2));
    double jitter = bb_random_range(random, -64, 64) * 0x1p-24 * reach;
    at[0] = bb_random_below(random, 2) ? step * bb_random_range(random, -1, 1)
                                       : corners[0][0] + 2 * s * reach;
    at[1] = bb_random_below(random, 8) == 0 ? width * bb_random_unit(random) : jitter;
    at[2] = 1;
    *ray = (bb_ray){.tmax = INFINITY};
    for (int k = 0; k < 3; k++) {
        double o = move[k], d = 0;
        for (int a = 0; a < 3; a++) {
            o += from[a] * frame[a][k];
            d += (at[a] - from[a]) * frame[a][k];
        }
        ray->o[k] = (float)(o * scale);
        ray->d[k] = (float)d;
        for (int c = 0; c < 3; c++) {
            double v = move[k];
            for (int a = 0; a < 3; a++)
                v += corners[c][a] * frame[a][k];
            vertices[3 * c + k] = (float)(v * scale);
        }
    }
}

static batch make_batch(uint32_t count, uint64_t stream)
{
    batch b = {count, calloc(9 * (size_t)count, sizeof(float)), calloc(count, sizeof(bb_ray))};
    bb_random random = bb_random_make(seed, stream);
    for (uint32_t i = 0; i < count; i++)
        make_case(&random, b.vertices + 9 * (size_t)i, &b.rays[i]);
    return b;
}

static void free_batch(batch *b)
{
    free(b->vertices);
    free(b->rays);
}

static void fail_with(const batch *b, verdict v, const char *what)
{
    const float *c = b->vertices + 9 * (size_t)v.first;
    const bb_ray *r = &b->rays[v.first];
    fail_msg("%s: %u of %u hits are not in their own box; the first: o %a %a %a d %a %a %a, "
             "triangle %a %a %a, %a %a %a, %a %a %a (seed %llu)",
             what, v.lost, v.accepted, r->o[0], r->o[1], r->o[2], r->d[0], r->d[1], r->d[2], c[0],
             c[1], c[2], c[3], c[4], c[5], c[6], c[7], c[8], (unsigned long long)seed);
}

#define COMPRESSED "-DBB_WIDTH=8 -DBB_COMPRESSED=1"

static void what_the_triangle_test_accepts_is_in_its_box(void **state)
{
    (void)state;
    static const char *const boxes[] = {"", COMPRESSED};
    batch b = make_batch(1000000, 1);
    for (int k = 0; k < 4; k++) {
        const bool rough = k % 2 != 0;
        char what[96];
        verdict v = run(&b, 1.0f, rough, boxes[k / 2]);
        assert_true(v.accepted > b.count / 20);
        snprintf(what, sizeof what, "quotients %s %s", rough ? "off by 2.5 ulp" : "as they are",
                 boxes[k / 2]);
        if (v.lost > 0)
            fail_with(&b, v, what);
    }
    free_batch(&b);
}

/* With less padding something is lost: the cases are hard enough to tell. */
static void the_budget_is_needed(void **state)
{
    (void)state;
    batch b = make_batch(1000000, 1);
    static const char *const less[] = {
        "-DBB_SLAB_TEST=BB_SLAB_SIGN -DBB_PAD_BOX=0.0f",
        "-DBB_PAD_BOX=0.0f",
        "-DBB_PAD_BOX=0x1p-26f",
        "-DBB_PAD_DISTANCE=0.0f -DBB_PAD_BOX=0x1p-26f",
        COMPRESSED " -DBB_CWBVH_MARGIN=0.0f",
    };
    for (size_t i = 0; i < sizeof less / sizeof less[0]; i++) {
        verdict v = run(&b, 1.0f, true, less[i]);
        print_message("%s: %u of %u lost\n", less[i], v.lost, v.accepted);
        if (v.lost == 0)
            fail_msg("%s: nothing is lost (seed %llu)", less[i], (unsigned long long)seed);
    }
    free_batch(&b);
}

/* ---- a wall of two long triangles ---- */

/* They share the edge x = 1, y = 0.5, from z = -reach to z = reach. */
static bb_scene *make_wall(float reach)
{
    bb_scene *scene = load("single");
    const float v[18] = {1, 0.5f, -reach, 1, 0.5f, reach,  1, -reach, 0,
                         1, 0.5f, reach,  1, 0.5f, -reach, 1, reach,  0};
    check(bb_host_alloc(NULL, sizeof v, "v", &scene->vertices), "v");
    check(bb_host_alloc(NULL, 6 * sizeof(uint32_t), "i", &scene->prims[BB_TRIANGLE].data), "i");
    memcpy(scene->vertices, v, sizeof v);
    for (uint32_t i = 0; i < 6; i++)
        bb_scene_indices(scene)[i] = i;
    scene->prims[BB_TRIANGLE].count = scene->prim_count = 2;
    scene->vertex_count = 6;
    check(bb_scene_finish(scene), "finish");
    return scene;
}

enum { WALL_RAYS = 100000 };

static void aim_at_wall(float reach, bb_ray *rays)
{
    bb_random random = bb_random_make(seed, 3);
    /* the first is one that was lost, with reach = 100 */
    rays[0] = (bb_ray){.o = {0x1.643382p-4f, 0x1.6cd294p-8f, -0x1.7e2650p-4f},
                       .d = {0x1.d37990p-1f, 0x1.fa4c74p-2f, 0x1.a236e0p+0f},
                       .tmax = INFINITY};
    for (uint32_t i = 1; i < WALL_RAYS; i++) {
        rays[i] = (bb_ray){.tmax = INFINITY};
        const double at[3] = {1, 0.5 + 4 * 0x1p-24 * reach * bb_random_range(&random, -1, 1),
                              reach * bb_random_range(&random, -0.5, 0.5) *
                                  pow(bb_random_unit(&random), 4)};
        for (int k = 0; k < 3; k++) {
            rays[i].o[k] = (float)bb_random_range(&random, -0.1, 0.1);
            rays[i].d[k] = (float)(at[k] - rays[i].o[k]);
        }
    }
}

/* Takes a bed over the tree without a node, and one over another tree: whether all kernels answer
 * on the other as brute force does, bit for bit. `hits` gets the answers. */
static void compare_with_brute_force(bed *brute, bed *b, const bb_ray *rays, uint32_t count,
                                     const char *what, bb_hit *hits)
{
    bb_hit *others = calloc(count, sizeof *others);
    trace(brute, "exact", rays, count, &bb_query_closest, hits, NULL);
    for (const bb_kernel *const *k = bb_kernels; *k != NULL; k++) {
        choose_kernel(b, (*k)->name, 1);
        trace(b, "exact", rays, count, &bb_query_closest, others, NULL);
        for (uint32_t i = 0; i < count; i++)
            if (memcmp(&hits[i], &others[i], sizeof hits[i]) != 0)
                fail_msg("%s, kernel %s, ray %u: %u at %a, brute force %u at %a (seed %llu)", what,
                         (*k)->name, i, others[i].prim, others[i].t, hits[i].prim, hits[i].t,
                         (unsigned long long)seed);
    }
    free(others);
    close_bed(b);
    close_bed(brute);
}

static void no_ray_passes_a_wall(void **state)
{
    (void)state;
    static const float reaches[] = {50, 100, 1000, 1e5f, 1e6f};
    bb_ray *rays = calloc(WALL_RAYS, sizeof *rays);
    bb_hit *hits = calloc(WALL_RAYS, sizeof *hits);
    for (size_t r = 0; r < sizeof reaches / sizeof reaches[0]; r++) {
        aim_at_wall(reaches[r], rays);
        bed brute, b;
        char what[64];
        snprintf(what, sizeof what, "reach %g", reaches[r]);
        open_bed(&brute, make_wall(reaches[r]), "null", "stack", 1);
        open_bed(&b, make_wall(reaches[r]), "lbvh", "stack", 1);
        compare_with_brute_force(&brute, &b, rays, WALL_RAYS, what, hits);
        for (uint32_t i = 0; i < WALL_RAYS; i++)
            if (hits[i].prim == BB_NONE)
                fail_msg("reach %g: ray %u passes (seed %llu)", reaches[r], i,
                         (unsigned long long)seed);
    }
    free(rays);
    free(hits);
}

/* ---- from afar ---- */

enum { FAR_RAYS = 20000 };

/* Distances are padded in proportion to themselves: from far enough each box is as wide as the
 * scene, and even places without a child would be met. */
/* Spheres whose radius is down to the last place of their centre: rays at the centre must hit. */
static void spheres_small_beside_their_place_are_hit(void **state)
{
    (void)state;
    enum { AIMED = 4000 };
    static const float radii[] = {1e-3f, 1e-5f, 1e-6f, 1e-7f};
    bb_ray *rays = calloc(AIMED, sizeof *rays);
    bb_hit *hits = calloc(AIMED, sizeof *hits);
    bb_random random = bb_random_make(seed, 5);
    for (size_t r = 0; r < sizeof radii / sizeof radii[0]; r++) {
        bed b;
        bb_scene *scene = load("spheres:n=10");
        const float place[4] = {-12.8f, 0.3f, -12.8f, radii[r]};
        memcpy(bb_scene_floats(scene, BB_SPHERE), place, sizeof place);
        check(bb_scene_finish(scene), "finish");
        open_bed(&b, scene, "lbvh", "stack", 1);
        for (uint32_t i = 0; i < AIMED; i++) {
            double away[3];
            bb_random_direction(&random, away);
            rays[i] = (bb_ray){.tmax = INFINITY};
            for (int k = 0; k < 3; k++) {
                rays[i].o[k] = (float)(place[k] + 100 * (double)radii[r] * away[k]);
                rays[i].d[k] = place[k] - rays[i].o[k];
            }
            if (rays[i].d[0] == 0 && rays[i].d[1] == 0 && rays[i].d[2] == 0)
                rays[i].d[0] = 1;
        }
        for (const bb_kernel *const *k = bb_kernels; *k != NULL; k++) {
            choose_kernel(&b, (*k)->name, 1);
            trace(&b, "exact", rays, AIMED, &bb_query_closest, hits, NULL);
            for (uint32_t i = 0; i < AIMED; i++)
                if (hits[i].prim != 0)
                    fail_msg("radius %g, kernel %s, ray %u: %u (seed %llu)", radii[r], (*k)->name,
                             i, hits[i].prim, (unsigned long long)seed);
        }
        close_bed(&b);
    }
    free(rays);
    free(hits);
}

static void from_afar_kernels_answer_alike(void **state)
{
    (void)state;
    bb_random random = bb_random_make(seed, 4);
    bb_ray *rays = calloc(FAR_RAYS, sizeof *rays);
    bb_hit *hits = calloc(FAR_RAYS, sizeof *hits);
    static const char *const cases[][2] = {
        {"sphere-mesh:n=20", "lbvh"},
        {"spheres:n=1000,state=settled", "lbvh"},
        {"awkward:kind=outlier,n=1000", "embree:quality=medium"}, /* deep: it fills its stack */
    };
    for (size_t s = 0; s < sizeof cases / sizeof cases[0]; s++) {
        bed brute, b;
        open_bed(&brute, load(cases[s][0]), "null", "stack", 1);
        open_bed(&b, load(cases[s][0]), cases[s][1], "stack", 1);
        for (uint32_t i = 0; i < FAR_RAYS; i++) {
            double away[3];
            double distance =
                b.scene->profile.size_median * pow(2, bb_random_range(&random, 0, 33));
            const bb_box *at = &b.scene->boxes[bb_random_below(&random, b.scene->prim_count)];
            bb_random_direction(&random, away);
            rays[i] = (bb_ray){.tmax = INFINITY};
            for (int k = 0; k < 3; k++) {
                double target = bb_random_range(&random, at->lo[k], at->hi[k]);
                rays[i].o[k] = (float)(target + distance * away[k]);
                rays[i].d[k] = (float)(target - (double)rays[i].o[k]);
            }
        }
        compare_with_brute_force(&brute, &b, rays, FAR_RAYS, cases[s][0], hits);
        uint32_t met = 0;
        for (uint32_t i = 0; i < FAR_RAYS; i++)
            met += hits[i].prim != BB_NONE;
        assert_true(met > FAR_RAYS / 4);
    }
    free(rays);
    free(hits);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_the_triangle_test_accepts_is_in_its_box),
        cmocka_unit_test(the_budget_is_needed),
        cmocka_unit_test(no_ray_passes_a_wall),
        cmocka_unit_test(spheres_small_beside_their_place_are_hit),
        cmocka_unit_test(from_afar_kernels_answer_alike),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
