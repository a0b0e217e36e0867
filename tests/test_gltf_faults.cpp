/* Why the glTF loader checks what it checks: what tinygltf alone makes of each kind of file, beside
 * what the loader makes of it. A fault that the installed tinygltf no longer has is printed, since
 * then its check may go; the loader has to be right in any case. */
#include <tiny_gltf.h>

extern "C" {
#include "tests/scene_files.h"
}

#include <csignal>
#include <functional>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace
{
using tinygltf::Model;

const char *path_of(const char *name)
{
    return test_path("gltf_faults", name);
}

/* One triangle; `more` follows, and hides members of the same name. */
std::string document(const std::string &more)
{
    return "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":36,\"uri\":"
           "\"data:application/octet-stream;base64,"
           "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}],\"bufferViews\":[{\"buffer\":0,"
           "\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,"
           "\"count\":3,\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":[{\"attributes\":"
           "{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0}]" +
           more + "}";
}

bool alone(const std::string &text, Model &model, std::string &error)
{
    tinygltf::TinyGLTF library;
    std::string warning;
    return library.LoadASCIIFromString(&model, &error, &warning, text.data(),
                                       static_cast<unsigned>(text.size()), path_of("."));
}

void note(bool shown, const char *what)
{
    if (!shown)
        print_message("this tinygltf no longer does: %s\n", what);
}

/* ---- taken, though wrong ---- */

struct Taken {
    const char *what;
    std::string more;
    std::function<bool(const Model &)> misread;
    const char *words; /* of the loader's refusal */
};

std::string accessor(const char *members)
{
    return std::string(",\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,"
                       "\"type\":\"VEC3\",") +
           members + "}]";
}

std::string primitive(const char *members)
{
    return std::string(",\"meshes\":[{\"primitives\":[{") + members + "}]}]";
}

const char *const two_nodes = ",\"nodes\":[{\"mesh\":0,\"children\":[1]},{\"children\":[0]}]";

std::vector<Taken> taken()
{
    return {
        {"an index that is a string counts as absent", ",\"nodes\":[{\"mesh\":\"0\"}]",
         [](const Model &m) { return m.nodes[0].mesh == -1; }, "must be a whole number"},
        {"an index that is a fraction counts as absent", ",\"nodes\":[{\"mesh\":0.5}]",
         [](const Model &m) { return m.nodes[0].mesh == -1; }, "must be a whole number"},
        {"an index is cut to 32 bits", ",\"nodes\":[{\"mesh\":4294967296}]",
         [](const Model &m) { return m.nodes[0].mesh == 0; }, "mesh is 4294967296"},
        {"an index beyond its list", ",\"nodes\":[{\"mesh\":7}]",
         [](const Model &m) { return m.nodes[0].mesh == 7 && m.meshes.size() == 1; },
         "mesh is 7, but there are 1"},
        {"a list that is an object counts as absent", ",\"nodes\":{\"mesh\":0}",
         [](const Model &m) { return m.nodes.empty(); }, "not an array"},
        {"a matrix that is a string counts as absent", ",\"nodes\":[{\"mesh\":0,\"matrix\":\"x\"}]",
         [](const Model &m) { return m.nodes[0].matrix.empty(); }, "matrix is not an array"},
        {"a scale of two numbers", ",\"nodes\":[{\"mesh\":0,\"scale\":[1,2]}]",
         [](const Model &m) { return m.nodes[0].scale.size() == 2; }, "scale is not 3 numbers"},
        {"what stands beside a matrix is lost",
         ",\"nodes\":[{\"mesh\":0,\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],"
         "\"translation\":[0,0,5]}]",
         [](const Model &m) { return m.nodes[0].translation.empty(); }, "one must go"},
        {"nodes in a cycle", two_nodes,
         [](const Model &m) { return m.nodes[1].children == std::vector<int>{0}; }, "cycle"},
        {"a child that is a string ends the list",
         ",\"nodes\":[{\"mesh\":0,\"children\":[1,\"2\"]},{},{}]",
         [](const Model &m) { return m.nodes[0].children == std::vector<int>{1}; },
         "must be a whole number"},
        {"a stride that is a string counts as absent",
         ",\"bufferViews\":[{\"buffer\":0,\"byteLength\":36,\"byteStride\":\"8\"}]",
         [](const Model &m) { return m.bufferViews[0].byteStride == 0; }, "byteStride is"},
        {"an offset below zero counts as absent", accessor("\"byteOffset\":-4"),
         [](const Model &m) { return m.accessors[0].byteOffset == 0; }, "byteOffset is -4"},
        {"normalized that is a number counts as false", accessor("\"normalized\":1"),
         [](const Model &m) { return !m.accessors[0].normalized; }, "not true or false"},
        {"elements beyond the view", accessor("\"byteOffset\":4"),
         [](const Model &m) { return m.accessors[0].byteOffset == 4; }, "reach beyond"},
        {"no elements", accessor("\"count\":0"),
         [](const Model &m) { return m.accessors[0].count == 0; }, "count is 0"},
        {"a sparse part's offset is cut to 32 bits",
         accessor("\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":0,\"componentType\":5121,"
                  "\"byteOffset\":4294967296},\"values\":{\"bufferView\":0}}"),
         [](const Model &m) { return m.accessors[0].sparse.indices.byteOffset == 0; },
         "byteOffset is 4294967296"},
        {"a mode that there is not", primitive("\"attributes\":{\"POSITION\":0},\"mode\":9"),
         [](const Model &m) { return m.meshes[0].primitives[0].mode == 9; }, "mode is 9"},
        {"a primitive that cannot be read is left out", primitive("\"attributes\":7"),
         [](const Model &m) { return m.meshes[0].primitives.empty(); }, "not a JSON object"},
        {"a primitive without attributes is left out", primitive("\"mode\":4"),
         [](const Model &m) { return m.meshes[0].primitives.empty(); }, "'attributes' property"},
        {"another version", ",\"asset\":{\"version\":\"1.0\"}",
         [](const Model &m) { return m.asset.version == "1.0"; }, "version '1.0'"},
        {"an extension that it cannot read", ",\"extensionsRequired\":[\"VENDOR_new\"]",
         [](const Model &m) { return m.extensionsRequired.size() == 1; }, "VENDOR_new"},
    };
}

void wrong_files_are_taken(void **)
{
    int shown = 0;
    for (const Taken &fault : taken()) {
        Model model;
        std::string error;
        const std::string text = document(fault.more);
        const bool misread = alone(text, model, error) && fault.misread(model);
        note(misread, fault.what);
        shown += misread;
        write_text(path_of("taken.gltf"), text.c_str());
        bb_scene *scene = nullptr;
        if (bb_scene_load(path_of("taken.gltf"), &scene) == BB_OK ||
            strstr(bb_message(), fault.words) == nullptr)
            fail_msg("%s: %s", fault.what, scene != nullptr ? "was read" : bb_message());
    }
    assert_true(shown > 0);
}

/* ---- refused, though right ---- */

struct Refused {
    const char *what;
    std::string more;
    uint32_t triangles = 1;
};

std::string buffer(const char *members)
{
    return std::string(",\"buffers\":[{\"byteLength\":36,") + members + "}]";
}

void right_files_are_refused(void **)
{
    static const float corners[16] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    write_bytes(path_of("a+b.bin"), corners, 36);
    write_bytes(path_of("long.bin"), corners, sizeof corners);
    const Refused cases[] = {
        {"a name with a plus", buffer("\"uri\":\"a+b.bin\"")},
        {"a file that is longer than byteLength", buffer("\"uri\":\"long.bin\"")},
        {"base64 of another media type",
         buffer("\"uri\":\"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"")},
        {"a buffer without data that nothing uses",
         ",\"buffers\":[{\"byteLength\":36,\"uri\":\"a+b.bin\"},{\"byteLength\":4}]"},
        {"indices without a bufferView",
         ",\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
         "{\"componentType\":5123,\"count\":9,\"type\":\"SCALAR\"}],\"meshes\":[{\"primitives\":[{"
         "\"attributes\":{\"POSITION\":0},\"indices\":1}]}]",
         3},
        {"an image without data", ",\"images\":[{}]"},
        {"an image in a view that there is not", ",\"images\":[{\"bufferView\":9}]"},
        {"a camera without a type", ",\"cameras\":[{}]"},
        {"an animation that is no object", ",\"animations\":[7]"},
        {"a skin that is no object", ",\"skins\":[7]"},
        {"a light without a type", ",\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{}]}}"},
    };
    int shown = 0;
    for (const Refused &fault : cases) {
        Model model;
        std::string error;
        const std::string text = document(fault.more);
        const bool refused = !alone(text, model, error);
        note(refused, fault.what);
        shown += refused;
        write_text(path_of("refused.gltf"), text.c_str());
        bb_scene *scene = load_scene(path_of("refused.gltf"));
        assert_int_equal(scene->prims[BB_TRIANGLE].count, fault.triangles);
        for (uint32_t i = 3; i < 3 * fault.triangles; i++)
            assert_int_equal(bb_scene_indices(scene)[i], 0);
        bb_scene_free(scene);
    }
    assert_true(shown > 0);
}

/* ---- dangerous ---- */

/* The header of the BIN chunk isn't counted: eight bytes behind the file are taken for data. */
void bytes_behind_the_file_are_read(void **)
{
    std::string text = "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":12}]}";
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const uint32_t json = static_cast<uint32_t>(text.size()), said = 12, there = 4;
    const uint32_t head[] = {0x46546C67, 2, 12 + 8 + json + 8 + there, json, 0x4E4F534A};
    const uint32_t next[] = {said, 0x004E4942};
    std::string file(reinterpret_cast<const char *>(head), sizeof head);
    file += text;
    file.append(reinterpret_cast<const char *>(next), sizeof next);
    file += "data";
    assert_int_equal(file.size(), head[2]);
    write_bytes(path_of("behind.glb"), file.data(), file.size());
    expect_failure(path_of("behind.glb"), BB_INVALID, "is truncated: chunk 1 has 12 bytes");

    const std::string memory = file + "not mine";
    tinygltf::TinyGLTF library;
    Model model;
    std::string error, warning;
    const bool done = library.LoadBinaryFromMemory(
        &model, &error, &warning, reinterpret_cast<const unsigned char *>(memory.data()),
        static_cast<unsigned>(file.size()));
    const bool read = done && model.buffers[0].data.size() == 12 &&
                      memcmp(model.buffers[0].data.data() + 4, "not mine", 8) == 0;
    note(read, "reads behind a GLB file");
}

/* A level of nested extras is a level of its stack. */
void deep_extras_crash(void **)
{
    const std::string deep(1000000, '['), end(1000000, ']');
    const std::string text = document(",\"nodes\":[{\"mesh\":0,\"extras\":" + deep + end + "}]");
    write_text(path_of("deep.gltf"), text.c_str());
    expect_failure(path_of("deep.gltf"), BB_INVALID, "nested deeper");
    const pid_t child = fork();
    if (child == 0) {
        const struct rlimit none = {0, 0};
        setrlimit(RLIMIT_CORE, &none);
        assert_non_null(freopen("/dev/null", "w", stderr));
        signal(SIGSEGV, SIG_DFL); /* cmocka's handler has no stack to run on */
        Model model;
        std::string error;
        alone(text, model, error);
        _exit(0);
    }
    int status = 0;
    assert_int_equal(waitpid(child, &status, 0), child);
    note(!WIFEXITED(status) || WEXITSTATUS(status) != 0, "crashes on deep extras");
}

/* tinygltf opens what the uri says, wherever that is, and also looks in the working directory. */
void files_from_elsewhere_are_read(void **)
{
    static const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const std::string folder = path_of(".");
    mkdir((folder + "/sub").c_str(), 0777);
    write_bytes((folder + "/outside.bin").c_str(), corners, sizeof corners);
    write_bytes((folder + "/sub/here.bin").c_str(), corners, sizeof corners);
    const struct {
        const char *what, *name;
        std::string uri, words;
    } cases[] = {
        {"a file above the document's folder", "sub/up.gltf", "../outside.bin", "leave its folder"},
        {"a file of the working directory", "cwd.gltf", "here.bin", "No such file"},
    };
    char before[4096];
    assert_non_null(getcwd(before, sizeof before));
    for (const auto &fault : cases) {
        const std::string path = folder + "/" + fault.name;
        write_text(path.c_str(),
                   document(buffer(("\"uri\":\"" + fault.uri + "\"").c_str())).c_str());
        assert_int_equal(chdir((folder + "/sub").c_str()), 0);
        tinygltf::TinyGLTF library;
        Model model;
        std::string error, warning;
        note(library.LoadASCIIFromFile(&model, &error, &warning, path), fault.what);
        expect_failure(path.c_str(), BB_INVALID, fault.words.c_str());
        assert_int_equal(chdir(before), 0);
    }
}
} // namespace

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wrong_files_are_taken),          cmocka_unit_test(right_files_are_refused),
        cmocka_unit_test(bytes_behind_the_file_are_read), cmocka_unit_test(deep_extras_crash),
        cmocka_unit_test(files_from_elsewhere_are_read),
    };
    return cmocka_run_group_tests_name("gltf_faults", tests, nullptr, nullptr);
}
