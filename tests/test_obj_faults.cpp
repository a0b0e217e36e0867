/* Why format_obj.cpp checks what it checks: what tinyobjloader alone makes of each kind of line. A
 * fault that the installed one no longer has is printed, since then its check may go. */
#include <sstream> /* before cmocka, whose fail() is a macro */
#include <string>
#include <tiny_obj_loader.h>
#include <vector>

extern "C" {
#include "tests/scene_files.h"
}

namespace
{
struct Seen {
    std::vector<float> numbers;
    std::vector<int> indices;
};

void take_vertex(void *user, float x, float y, float z, float)
{
    std::vector<float> &numbers = static_cast<Seen *>(user)->numbers;
    numbers.insert(numbers.end(), {x, y, z});
}

void take_face(void *user, tinyobj::index_t *indices, int count)
{
    for (int i = 0; i < count; i++)
        static_cast<Seen *>(user)->indices.push_back(indices[i].vertex_index);
}

struct Fault {
    const char *what, *text;
    std::vector<float> numbers; /* that it reads, as if nothing were wrong */
    std::vector<int> indices;
    const char *words; /* of the loader's refusal; NULL: it reads it rightly */
};

#define THREE "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
const std::vector<float> three = {0, 0, 0, 1, 0, 0, 0, 1, 0};

const Fault faults[] = {
    {"takes what is no number for 0", "v 1 x 2\n", {1, 0, 2}, {}, "'x' is no finite number"},
    {"takes nan for 0", "v 1 nan 2\n", {1, 0, 2}, {}, "'nan' is no finite number"},
    {"takes the beginning of a number", "v 1 2.5.7 2\n", {1, 2.5, 2}, {}, "'2.5.7' is no finite"},
    {"takes a missing coordinate for 0", "v 1 2\n", {1, 2, 0}, {}, "fewer than three numbers"},
    {"cuts indices to 32 bits", THREE "f 1 2 4294967299\n", three, {1, 2, 3}, "'4294967299' is no"},
    {"takes the beginning of an index", THREE "f 1 2 3x\n", three, {1, 2, 3}, "'3x' is no v,"},
    {"takes a remark for corners", THREE "f 1 2 3 # b\n", three, {1, 2, 3, 0, 0}, nullptr},
    {"knows no continued lines", THREE "f 1 2 \\\n3\n", three, {1, 2, 0}, nullptr},
};

void test_faults(void **)
{
    for (const Fault &fault : faults) {
        Seen seen;
        tinyobj::callback_t callbacks;
        callbacks.vertex_cb = take_vertex;
        callbacks.index_cb = take_face;
        std::istringstream stream(fault.text);
        assert_true(tinyobj::LoadObjWithCallback(stream, callbacks, &seen));
        if (seen.numbers != fault.numbers || seen.indices != fault.indices)
            print_message("this tinyobjloader no longer: %s\n", fault.what);

        const char *path = test_path("obj_faults", "case.obj");
        write_text(path, fault.text);
        if (fault.words != nullptr)
            expect_failure(path, BB_INVALID, fault.words);
        else
            bb_scene_free(load_scene(path));
    }
}
} // namespace

int main()
{
    const CMUnitTest tests[] = {cmocka_unit_test(test_faults)};
    return cmocka_run_group_tests_name("obj_faults", tests, nullptr, nullptr);
}
