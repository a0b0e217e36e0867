/* Morph targets and skins of glTF clips, against what is computed here. */
#include "tests/gltf_maker.h"

#include <math.h>

static const float corners[] = {1, 0, 0, 0, 2, 0, 0, 0, 4};
static const float times[] = {0, 2};

static bb_scene *load_clip(const maker *m, const char *members, int frames)
{
    char text[1200];
    snprintf(text, sizeof text, "%s:clip=0,frames=%d",
             write_made(m, "gltf-skin", "made.gltf", members), frames);
    return load_scene(text);
}

/* ---- morph targets ---- */

/* Two targets: the first moves all, the second, sparse and otherwise without data, the last
 * vertex; a third moves no positions. */
static maker start_morph(void)
{
    static const float up[] = {0, 0, 1, 0, 0, 2, 0, 0, 3}, far[] = {100, 0, 0};
    static const uint8_t last[] = {2};
    maker m = {0};
    add_floats(&m, 3, 3, corners); /* 0 */
    add_floats(&m, 3, 3, up);
    add_bytes(&m, last, 1, "\"componentType\":5121,\"count\":1,\"type\":\"SCALAR\"");
    add_floats(&m, 1, 3, far);
    strcat(m.accessors, ",{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"sparse\":{"
                        "\"count\":1,\"indices\":{\"bufferView\":2,\"componentType\":5121},"
                        "\"values\":{\"bufferView\":3}}}"); /* 4 */
    strcat(m.views, ",{\"buffer\":0,\"byteLength\":4}");
    m.count++;
    add_floats(&m, 2, 1, times); /* 5 */
    return m;
}

#define MORPHED(weights)                                                                           \
    "\"meshes\":[{" weights "\"primitives\":[{\"attributes\":{\"POSITION\":0},\"targets\":["       \
    "{\"POSITION\":1},{\"POSITION\":4},{\"NORMAL\":7}]}]}]"

static void weights_move_vertices(void **state)
{
    (void)state;
    static const float weights[] = {0, 1, 0.5f, 1, 0.5f, 0.25f};
    maker m = start_morph();
    add_floats(&m, 6, 1, weights); /* 6 */
    bb_scene *scene = load_clip(
        &m,
        MORPHED("\"weights\":[9,9,9],") ",\"nodes\":[{\"mesh\":0,\"weights\":[8,8,8],"
                                        "\"translation\":[0,5,0]}],\"animations\":[{\"samplers\":["
                                        "{\"input\":5,\"output\":6}],\"channels\":[{\"sampler\":0,"
                                        "\"target\":{\"node\":0,\"path\":\"weights\"}}]}]",
        3);
    expect_vertex(scene, 0, 0, 1, 5, 0, 0);
    expect_vertex(scene, 0, 2, 100, 5, 4, 0);
    expect_vertex(scene, 1, 0, 1, 5, 0.5, 0);
    expect_vertex(scene, 1, 1, 0, 7, 1, 0);
    expect_vertex(scene, 1, 2, 75, 5, 5.5, 0);
    expect_vertex(scene, 2, 2, 50, 5, 7, 0);
    bb_scene_free(scene);
}

/* Weights that no channel moves: the node's, else the mesh's, else 0. */
static void weights_have_defaults(void **state)
{
    (void)state;
    static const float way[] = {0, 0, 0, 0, 8, 0};
    static const struct {
        const char *mesh, *node;
        double z;
    } cases[] = {{"", "", 0},
                 {"\"weights\":[2,0,0],", "", 2},
                 {"\"weights\":[2,0,0],", ",\"weights\":[0.5,0,0]", 0.5}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        maker m = start_morph();
        char members[1024];
        add_floats(&m, 2, 3, way);
        snprintf(members, sizeof members,
                 MORPHED("%s") ",\"nodes\":[{\"mesh\":0%s}],\"animations\":[{\"samplers\":[{"
                               "\"input\":5,\"output\":6}],\"channels\":[{\"sampler\":0,"
                               "\"target\":{\"node\":0,\"path\":\"translation\"}}]}]",
                 cases[i].mesh, cases[i].node);
        bb_scene *scene = load_clip(&m, members, 3);
        expect_vertex(scene, 1, 0, 1, 4, cases[i].z, 0);
        bb_scene_free(scene);
    }
}

/* ---- skins ---- */

#define TURNED                                                                                     \
    ",\"animations\":[{\"samplers\":[{\"input\":1,\"output\":2}],\"channels\":[{\"sampler\":0,"    \
    "\"target\":{\"node\":2,\"path\":\"rotation\"}}]}]"
/* The mesh's node has a transform that plays no part; joints 1 and 2, of which 2 turns about y. */
#define BONES(skin)                                                                                \
    ",\"nodes\":[{\"mesh\":0,\"skin\":0,\"translation\":[50,50,50]},{\"translation\":[0,1,0],"     \
    "\"children\":[2]},{\"translation\":[0,0,3]}],\"skins\":[{\"joints\":[1,2]" skin "}]" TURNED

static maker start_skin(void)
{
    static const float turn[] = {0, 0, 0, 1, 0, 0.6f, 0, 0.8f};
    maker m = {0};
    add_floats(&m, 3, 3, corners);
    add_floats(&m, 2, 1, times);
    add_floats(&m, 2, 4, turn);
    return m;
}

/* Where joint 0 or 1 takes a point at u = 0 .. 1, with inverse bind matrices that shift by -1 along
 * y, and by -1 and -3 along y and z. */
static void follow(int joint, double u, const double p[3], double out[3])
{
    const double angle = joint == 1 ? u * 2 * atan2((double)0.6f, (double)0.8f) : 0;
    const double x = p[0], z = joint == 1 ? p[2] - 3 : p[2];
    out[0] = x * cos(angle) + z * sin(angle);
    out[1] = p[1];
    out[2] = z * cos(angle) - x * sin(angle) + (joint == 1 ? 3 : 0);
}

static void two_bones_bend_a_mesh(void **state)
{
    (void)state;
    static const float shifts[32] = {[0] = 1,  [5] = 1,  [10] = 1,  [13] = -1, [15] = 1, [16] = 1,
                                     [21] = 1, [26] = 1, [29] = -1, [30] = -3, [31] = 1};
    static const uint8_t joints[] = {0, 1, 0, 0, 1, 0, 99, 99, 1, 1, 0, 0};
    static const uint8_t weights[] = {204, 51, 0, 0, 255, 0, 0, 0, 51, 51, 51, 102};
    static const double to_second[] = {0.2, 1, 0.4}; /* of each vertex */
    maker m = start_skin();
    add_floats(&m, 2, 16, shifts); /* 3 */
    add_bytes(&m, joints, sizeof joints, "\"componentType\":5121,\"count\":3,\"type\":\"VEC4\"");
    add_bytes(&m, weights, sizeof weights,
              "\"componentType\":5121,\"normalized\":true,\"count\":3,\"type\":\"VEC4\"");
    bb_scene *scene =
        load_clip(&m,
                  "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,"
                  "\"JOINTS_0\":4,\"WEIGHTS_0\":5}}]}]" BONES(",\"inverseBindMatrices\":3"),
                  9);
    for (uint32_t f = 0; f < 9; f++)
        for (uint32_t v = 0; v < 3; v++) {
            double p[3], first[3], second[3];
            for (int axis = 0; axis < 3; axis++)
                p[axis] = (double)corners[3 * v + (uint32_t)axis];
            follow(0, f / 8.0, p, first);
            follow(1, f / 8.0, p, second);
            const double b = to_second[v];
            expect_vertex(scene, f, v, (1 - b) * first[0] + b * second[0],
                          (1 - b) * first[1] + b * second[1], (1 - b) * first[2] + b * second[2],
                          3e-7);
        }
    bb_scene_free(scene);
}

/* Identities without matrices; weights of any sum; a second set; vertices of no weight stay. */
static void sets_and_sums_of_weights(void **state)
{
    (void)state;
    static const uint16_t joints[24] = {0}, others[24] = {[0] = 1, [4] = 1};
    static const float weights[] = {3, 0, 0, 0, 0.25f, 0, 0, 0, 0, 0, 0, 0};
    static const float more[] = {1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    maker m = start_skin();
    add_bytes(&m, joints, 24, "\"componentType\":5123,\"count\":3,\"type\":\"VEC4\"");
    add_floats(&m, 3, 4, weights);
    add_bytes(&m, others, 24, "\"componentType\":5123,\"count\":3,\"type\":\"VEC4\"");
    add_floats(&m, 3, 4, more);
    bb_scene *scene = load_clip(&m,
                                "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,"
                                "\"JOINTS_0\":3,\"WEIGHTS_0\":4,\"JOINTS_1\":5,\"WEIGHTS_1\":6}}]}"
                                "]" BONES(""),
                                2);
    /* (1 0 0) is taken to (1 1 0) by 3/4 and to (1 1 3) by 1/4. */
    expect_vertex(scene, 0, 0, 1, 1, 0.75, 0);
    expect_vertex(scene, 0, 1, 0, 3, 0, 0);
    expect_vertex(scene, 0, 2, 0, 0, 4, 0);
    expect_vertex(scene, 1, 2, 0, 0, 4, 0);
    bb_scene_free(scene);
}

/* Primitives of one position accessor share vertices only if those move alike. Matrices may be
 * singular. */
static void vertices_that_part_are_not_shared(void **state)
{
    (void)state;
    static const float flat[32] = {[0] = 1, [5] = 1, [15] = 1, [16] = 1, [21] = 1, [31] = 1};
    static const uint8_t first[12] = {0}, second[12] = {[0] = 1, [4] = 1, [8] = 1};
    static const float whole[] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    maker m = start_skin();
    add_bytes(&m, first, 12, "\"componentType\":5121,\"count\":3,\"type\":\"VEC4\"");
    add_bytes(&m, second, 12, "\"componentType\":5121,\"count\":3,\"type\":\"VEC4\"");
    add_floats(&m, 3, 4, whole);
    add_floats(&m, 2, 16, flat);
    bb_scene *scene = load_clip(
        &m,
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"JOINTS_0\":3,"
        "\"WEIGHTS_0\":5}},{\"attributes\":{\"POSITION\":0,\"JOINTS_0\":4,\"WEIGHTS_0\":5}},"
        "{\"attributes\":{\"POSITION\":0,\"JOINTS_0\":3,\"WEIGHTS_0\":5}}]}]" BONES(
            ",\"inverseBindMatrices\":6"),
        2);
    assert_int_equal(scene->prim_count, 3);
    assert_int_equal(scene->vertex_count, 6);
    expect_vertex(scene, 0, 2, 0, 1, 0, 0); /* (0 0 4), flattened */
    expect_vertex(scene, 0, 5, 0, 1, 3, 0);
    bb_scene_free(scene);
}

/* Targets move the mesh before its joints do. */
static void morphed_meshes_have_skins(void **state)
{
    (void)state;
    static const float out[] = {1, 0, 0, 0, 0, 0, 0, 0, 0},
                       whole[] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    static const uint8_t second[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    maker m = start_skin();
    add_bytes(&m, second, 12, "\"componentType\":5121,\"count\":3,\"type\":\"VEC4\"");
    add_floats(&m, 3, 4, whole);
    add_floats(&m, 3, 3, out);
    bb_scene *scene =
        load_clip(&m,
                  "\"meshes\":[{\"weights\":[2],\"primitives\":[{\"attributes\":{\"POSITION\":0,"
                  "\"JOINTS_0\":3,\"WEIGHTS_0\":4},\"targets\":[{\"POSITION\":5}]}]}]" BONES(""),
                  2);
    const double angle = 2 * atan2((double)0.6f, (double)0.8f);
    expect_vertex(scene, 0, 0, 3, 1, 3, 0);
    expect_vertex(scene, 1, 0, 3 * cos(angle), 1, 3 - 3 * sin(angle), 3e-7);
    bb_scene_free(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(weights_move_vertices),
        cmocka_unit_test(weights_have_defaults),
        cmocka_unit_test(two_bones_bend_a_mesh),
        cmocka_unit_test(sets_and_sums_of_weights),
        cmocka_unit_test(vertices_that_part_are_not_shared),
        cmocka_unit_test(morphed_meshes_have_skins),
    };
    return cmocka_run_group_tests_name("gltf_skin", tests, NULL, NULL);
}
