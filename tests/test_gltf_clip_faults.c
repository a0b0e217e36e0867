/* What is refused of glTF clips: one line that says what and where. */
#include "tests/gltf_maker.h"

#include <dirent.h>
#include <math.h>

#define CORPUS BB_TEST_SOURCE_DIR "/../shared/data/awkward"

/* ---- a sound file, of which each case changes a part ---- */

typedef struct parts {
    const char *targets, *attributes; /* of the primitive */
    const char *mesh, *node;          /* more members of both */
    const char *skin;                 /* the skin's members */
    const char *channel;              /* all of it */
    const char *sampler;              /* the same */
    const char *more;                 /* of the document, with a comma */
} parts;

#define CHANNEL(node, path) "{\"sampler\":0,\"target\":{\"node\":" #node ",\"path\":\"" path "\"}}"
#define SAMPLER(input, output) "{\"input\":" #input ",\"output\":" #output "}"

static const parts sound = {
    .targets = "{\"POSITION\":0}",
    .attributes = "\"POSITION\":0,\"JOINTS_0\":5,\"WEIGHTS_0\":6",
    .mesh = "",
    .node = ",\"skin\":0",
    .skin = "\"joints\":[1],\"inverseBindMatrices\":7",
    .channel = CHANNEL(1, "translation"),
    .sampler = SAMPLER(1, 2),
    .more = "",
};

static maker make_data(void)
{
    static const float corners[] = {1, 0, 0, 0, 2, 0, 0, 0, 4}, times[] = {0, 1},
                       way[] = {0, 0, 0, 3e38f, 0, 0}, turn[] = {0, 0, 0, 1, 0, 0, 0, 1},
                       weights[] = {1, 0}, whole[] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0},
                       identity[16] = {[0] = 1, [5] = 1, [10] = 1, [15] = 1};
    static const float back[] = {0, 0}, none[] = {NAN, 1}, endless[] = {0, 0, 0, INFINITY, 0, 0},
                       nothing[] = {0, 0, 0, 1, 0, 0, 0, 0}, over[] = {0, 0, 0, 1, 0, 0, 0, -1},
                       below[] = {1, -1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0},
                       tilted[16] = {[0] = 1, [3] = 1, [5] = 1, [10] = 1, [15] = 1},
                       bad[16] = {[0] = NAN, [15] = 1}, apart[9] = {[3] = INFINITY};
    static const uint8_t joints[12] = {0}, far[12] = {[4] = 7};
    static const char bytes[] = "\"componentType\":5121,\"count\":3,\"type\":\"VEC4\"";
    maker m = {0};
    add_floats(&m, 3, 3, corners);
    add_floats(&m, 2, 1, times);
    add_floats(&m, 2, 3, way);
    add_floats(&m, 2, 4, turn);
    add_floats(&m, 2, 1, weights);
    add_bytes(&m, joints, sizeof joints, bytes);
    add_floats(&m, 3, 4, whole);
    add_floats(&m, 1, 16, identity);
    add_floats(&m, 2, 1, back); /* 8 */
    add_floats(&m, 2, 1, none);
    add_floats(&m, 2, 3, endless); /* 10 */
    add_floats(&m, 2, 4, nothing);
    add_floats(&m, 2, 4, over); /* 12 */
    add_floats(&m, 3, 4, below);
    add_floats(&m, 1, 16, tilted); /* 14 */
    add_floats(&m, 1, 16, bad);
    add_bytes(&m, far, sizeof far, bytes); /* 16 */
    add_floats(&m, 3, 3, apart);
    strcat(m.accessors,
           ",{\"componentType\":5126,\"count\":1000000000000,\"type\":\"SCALAR\"}" /* 18 */
           ",{\"componentType\":5126,\"count\":16000000,\"type\":\"SCALAR\"}"
           ",{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}"); /* 20 */
    return m;
}

static const char *write_parts(const parts *p)
{
    static char members[1 << 13];
    const maker m = make_data();
    snprintf(members, sizeof members,
             "\"meshes\":[{\"primitives\":[{\"attributes\":{%s},\"targets\":[%s]}]%s}],"
             "\"nodes\":[{\"mesh\":0%s},{},{\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]},{}],"
             "\"scenes\":[{\"nodes\":[0,1,2]}],\"skins\":[{%s}],\"animations\":[{\"name\":\"Go\","
             "\"channels\":[%s],\"samplers\":[%s]},{\"channels\":[],\"samplers\":[]},{\"name\":"
             "\"two\"},{\"name\":\"two\"}]%s",
             p->attributes, p->targets, p->mesh, p->node, p->skin, p->channel, p->sampler, p->more);
    return write_made(&m, "gltf-clip-faults", "case.gltf", members);
}

static void expect_refused(const parts *p, const char *options, bb_status status, const char *words)
{
    char text[1200];
    snprintf(text, sizeof text, "%s:%s", write_parts(p), options);
    expect_failure(text, status, words);
}

typedef struct change {
    size_t part; /* its place in `parts` */
    const char *text, *words;
} change;

#define PART(name) offsetof(parts, name)

static void try_changes(const change *changes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        parts p = sound;
        memcpy((char *)&p + changes[i].part, &changes[i].text, sizeof changes[i].text);
        expect_refused(&p, "clip=0,frames=3", BB_INVALID, changes[i].words);
        /* Nobody looks unless a clip is asked for. */
        if (changes[i].part != PART(attributes) && changes[i].part != PART(targets))
            bb_scene_free(load_scene(write_parts(&p)));
    }
}

#define TRY(changes) try_changes(changes, sizeof(changes) / sizeof((changes)[0]))

/* ---- the clip's name ---- */

static void clips_that_there_are_not(void **state)
{
    (void)state;
    expect_refused(&sound, "clip=Stop", BB_INVALID, "no clip 'Stop': take one of 0 Go, 1, 2 two");
    expect_refused(&sound, "clip=4", BB_INVALID, "no clip '4': take one of 0 Go");
    expect_refused(&sound, "clip=18446744073709551616", BB_INVALID, "no clip '18446744073709551");
    expect_refused(&sound, "clip=two", BB_INVALID, "2 clips are called 'two'");
    expect_refused(&sound, "clip=1", BB_INVALID, "clip 1: moves no node");
    expect_refused(&sound, "frames=9", BB_INVALID, "frames= needs clip=");
    expect_refused(&sound, "clip=0,frames=1", BB_INVALID, "whole number from 2 to 1000000");
    expect_refused(&sound, "clip=", BB_INVALID, "is not key=value");
    bb_scene_free(load_scene(write_parts(&sound)));
    expect_failure(BB_TEST_SOURCE_DIR "/scenes/data/scorpion.glb:clip=0", BB_INVALID,
                   "it has no animations");
}

/* ---- channels ---- */

static void bad_channels(void **state)
{
    (void)state;
    static const change changes[] = {
        {PART(channel), "{\"sampler\":0}", "channel 0: has no target"},
        {PART(channel), "{\"target\":{\"node\":0,\"path\":\"scale\"}}", "or no valid sampler"},
        {PART(channel), "{\"sampler\":1,\"target\":{\"node\":0,\"path\":\"scale\"}}",
         "or no valid sampler"},
        {PART(channel), CHANNEL(9, "scale"), "node is 9, but there are 4 nodes"},
        {PART(channel), CHANNEL("0", "scale"), "must be a whole number"},
        {PART(channel), CHANNEL(1, "pointer"), "moves no node"},
        {PART(channel), "{\"sampler\":0,\"target\":{\"node\":1,\"path\":3}}", "not a string"},
        {PART(channel), CHANNEL(2, "scale"), "moves node 2, which has a matrix"},
        {PART(channel), CHANNEL(1, "scale") "," CHANNEL(1, "scale"),
         "the same property as another channel"},
        {PART(channel), CHANNEL(1, "weights"), "node 1, which has no morph targets"},
        {PART(channel), CHANNEL(1, "rotation"), "must be VEC4"},
        {PART(sampler), "{\"output\":2}", "no input"},
        {PART(sampler), "{\"input\":99,\"output\":2}", "there are 21 accessors"},
        {PART(sampler), "{\"input\":1,\"output\":2,\"interpolation\":\"linear\"}", "'linear'"},
        {PART(sampler), "{\"input\":1,\"output\":2,\"interpolation\":\"CUBICSPLINE\"}",
         "has 2 values, its 2 keyframes need 6"},
        {PART(sampler), SAMPLER(1, 0), "has 3 values, its 2 keyframes need 2"},
        {PART(sampler), SAMPLER(1, 20), "reach beyond"},
        {PART(sampler), SAMPLER(2, 2), "times: must be SCALAR of float"},
        {PART(sampler), SAMPLER(8, 2), "the time of keyframe 1 is 0: must be finite and rise"},
        {PART(sampler), SAMPLER(9, 2), "the time of keyframe 0 is nan"},
        {PART(sampler), SAMPLER(19, 2), "its times do not rise"},
        {PART(sampler), SAMPLER(1, 10), "the value of keyframe 1 is not finite"},
    };
    TRY(changes);
    parts p = sound;
    p.channel = CHANNEL(1, "rotation");
    p.sampler = SAMPLER(1, 11);
    expect_refused(&p, "clip=Go", BB_INVALID, "keyframe 1 is a quaternion of length 0");
    p.sampler = SAMPLER(18, 3);
    expect_refused(&p, "clip=Go", BB_REFUSED, "has 1000000000000 elements and no data");
    p.channel = CHANNEL(0, "weights");
    p.sampler = SAMPLER(1, 6);
    expect_refused(&p, "clip=Go", BB_INVALID, "weights: must be SCALAR");
    p = sound;
    p.more = ",\"extensionsRequired\":[\"KHR_animation_pointer\"]";
    expect_refused(&p, "clip=Go", BB_UNSUPPORTED, "KHR_animation_pointer");
}

/* ---- morph targets and skins ---- */

static void bad_targets(void **state)
{
    (void)state;
    static const change changes[] = {
        {PART(targets), "{\"POSITION\":2}", "morph target 0: has 2 vertices, the primitive has 3"},
        {PART(targets), "{\"POSITION\":20}", "reach beyond"},
        {PART(targets), "{\"POSITION\":1}", "must be VEC3"},
        {PART(targets), "{\"POSITION\":17}", "morph target 0: vertex 1 is moved by (inf 0 0)"},
        {PART(mesh), ",\"weights\":[1,2]", "mesh 0: has 2 weights, but its mesh has 1 morph"},
        {PART(mesh), ",\"weights\":[\"1\"]", "weights is not numbers"},
        {PART(node), ",\"weights\":[1,2]", "node 0: has 2 weights"},
    };
    TRY(changes);
    parts p = sound;
    p.more = ",\"accessors\":[]"; /* the last one counts: none */
    expect_refused(&p, "clip=0", BB_INVALID, "there are 0 accessors");
}

static void bad_skins(void **state)
{
    (void)state;
    static const change changes[] = {
        {PART(node), ",\"skin\":1", "skin is 1, but there are 1 skins"},
        {PART(skin), "", "skin 0 has no joints"},
        {PART(skin), "\"joints\":[]", "skin 0 has no joints"},
        {PART(skin), "\"joints\":[4]", "joints is 4, but there are 4 nodes"},
        {PART(skin), "\"joints\":[3]", "its joint 0 is node 3, which is in no scene"},
        {PART(skin), "\"joints\":[1,2],\"inverseBindMatrices\":7", "has 1 matrices for 2 joints"},
        {PART(skin), "\"joints\":[1],\"inverseBindMatrices\":3", "must be MAT4"},
        {PART(skin), "\"joints\":[1],\"inverseBindMatrices\":14", "the last row of the matrix"},
        {PART(skin), "\"joints\":[1],\"inverseBindMatrices\":15", "joint 0 is not finite"},
        {PART(attributes), "\"POSITION\":0", "has no JOINTS_0 and WEIGHTS_0"},
        {PART(attributes), "\"POSITION\":0,\"JOINTS_0\":5", "1 sets of JOINTS_ and 0 of WEIGHTS_"},
        {PART(attributes), "\"POSITION\":0,\"JOINTS_0\":5,\"WEIGHTS_0\":-1", "no valid accessor"},
        {PART(attributes), "\"POSITION\":0,\"JOINTS_0\":6,\"WEIGHTS_0\":6", "JOINTS_0: must be"},
        {PART(attributes), "\"POSITION\":0,\"JOINTS_0\":5,\"WEIGHTS_0\":5", "WEIGHTS_0: must be"},
        {PART(attributes), "\"POSITION\":0,\"JOINTS_0\":5,\"WEIGHTS_0\":3", "2 elements for 3"},
        {PART(attributes), "\"POSITION\":0,\"JOINTS_0\":16,\"WEIGHTS_0\":6",
         "vertex 1 follows joint 7, but its skin has 1"},
        {PART(attributes), "\"POSITION\":0,\"JOINTS_0\":5,\"WEIGHTS_0\":13",
         "vertex 0 has a weight of -1"},
    };
    TRY(changes);
}

/* ---- frames ---- */

/* The whole file is sound, but a vertex leaves the floats in the last frame; the scene can go
 * back. */
static void vertices_that_leave_the_floats(void **state)
{
    (void)state;
    char text[1200];
    static const float corners[] = {0, 0, 0, 2e38f, 0, 0, 0, 0, 4}, times[] = {0, 1},
                       way[] = {0, 0, 0, 2e38f, 0, 0};
    maker m = {0};
    add_floats(&m, 3, 3, corners);
    add_floats(&m, 2, 1, times);
    add_floats(&m, 2, 3, way);
    snprintf(text, sizeof text, "%s:clip=0,frames=3",
             write_made(&m, "gltf-clip-faults", "far.gltf",
                        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
                        "\"nodes\":[{\"mesh\":0}],\"animations\":[{\"channels\":[" CHANNEL(
                            0, "translation") "],\"samplers\":[" SAMPLER(1, 2) "]}]"));
    bb_scene *scene = load_scene(text);
    uint64_t hash = scene->hash;
    ASSERT_OK(bb_scene_set_frame(scene, 1, NULL));
    assert_int_equal(bb_scene_set_frame(scene, 2, NULL), BB_INVALID);
    assert_non_null(
        strstr(bb_message(), "frame 2, mesh 0, primitive 0: vertex 1 is not finite: (2e+38"));
    ASSERT_OK(bb_scene_set_frame(scene, 0, NULL));
    assert_true(scene->hash == hash);
    bb_scene_free(scene);
}

/* Half-way between a rotation and its opposite a straight spline has no length. */
static void rotations_that_vanish(void **state)
{
    (void)state;
    static const float corners[] = {1, 0, 0, 0, 2, 0, 0, 0, 4}, times[] = {0, 1};
    static const float turn[24] = {[7] = 1, [19] = -1};
    char text[1200];
    maker m = {0};
    add_floats(&m, 3, 3, corners);
    add_floats(&m, 2, 1, times);
    add_floats(&m, 6, 4, turn);
    snprintf(text, sizeof text, "%s:clip=0,frames=3",
             write_made(&m, "gltf-clip-faults", "vanish.gltf",
                        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
                        "\"nodes\":[{\"mesh\":0}],\"animations\":[{\"channels\":[" CHANNEL(
                            0, "rotation") "],\"samplers\":[{\"input\":1,\"output\":2,"
                                           "\"interpolation\":\"CUBICSPLINE\"}]}]"));
    bb_scene *scene = load_scene(text);
    assert_int_equal(bb_scene_set_frame(scene, 1, NULL), BB_INVALID);
    assert_non_null(
        strstr(bb_message(), "clip 0, frame 1: the rotation of node 0 is a quaternion"));
    ASSERT_OK(bb_scene_set_frame(scene, 2, NULL));
    bb_scene_free(scene);
}

/* ---- the files of others ---- */

typedef struct tally {
    int files, moving;
} tally;

static void try_file(const char *path, tally *tally)
{
    char text[1200];
    bb_scene *scene = NULL;
    snprintf(text, sizeof text, "%s:clip=0,frames=4", path);
    tally->files++;
    if (bb_scene_load(text, &scene) != BB_OK) {
        assert_null(scene);
        assert_null(strchr(bb_message(), '\n'));
        return;
    }
    tally->moving++;
    for (uint32_t f = 0; f < 4; f++)
        if (bb_scene_set_frame(scene, 3 - f, NULL) != BB_OK)
            assert_null(strchr(bb_message(), '\n'));
    bb_scene_free(scene);
}

static void walk(const char *folder, tally *tally)
{
    DIR *dir = opendir(folder);
    assert_non_null(dir);
    for (struct dirent *entry; (entry = readdir(dir)) != NULL;) {
        char path[1024];
        struct stat info;
        const char *ending = strrchr(entry->d_name, '.');
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        if (entry->d_name[0] == '.' || stat(path, &info) != 0)
            continue;
        if (S_ISDIR(info.st_mode))
            walk(path, tally);
        else if (ending != NULL && (strcmp(ending, ".gltf") == 0 || strcmp(ending, ".glb") == 0))
            try_file(path, tally);
    }
    closedir(dir);
}

static void files_of_others(void **state)
{
    (void)state;
    struct stat info;
    if (stat(CORPUS, &info) != 0) {
        print_message("skipped: there is no %s\n", CORPUS);
        skip();
    }
    tally tally = {0};
    walk(CORPUS, &tally);
    print_message("%d files, %d of them move\n", tally.files, tally.moving);
    assert_true(tally.files >= 200 && tally.moving >= 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clips_that_there_are_not),
        cmocka_unit_test(bad_channels),
        cmocka_unit_test(bad_targets),
        cmocka_unit_test(bad_skins),
        cmocka_unit_test(vertices_that_leave_the_floats),
        cmocka_unit_test(rotations_that_vanish),
        cmocka_unit_test(files_of_others),
    };
    return cmocka_run_group_tests_name("gltf_clip_faults", tests, NULL, NULL);
}
