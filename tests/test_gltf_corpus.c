/* Every awkward glTF file that other loaders have met: a scene or one clear line, and the right one
 * where the glTF validator's reference says that the file is damaged. Skips where the corpus is
 * absent. */
#include "tests/scene_files.h"

#include <cjson/cJSON.h>
#include <dirent.h>

#define CORPUS BB_TEST_SOURCE_DIR "/../shared/data/awkward"

/* What the validator refuses and this loader reads, on purpose: the triangles are not touched by
 * it. */
static const char *const harmless[] = {
    "NODE_SKIN_WITH_NON_SKINNED_MESH",
    "NODE_WEIGHTS_INVALID",
    "NODE_SKIN_NO_SCENE",
};

static char *read_text(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (file == NULL)
        return NULL;
    char *text = calloc(1, 1 << 20);
    assert_non_null(text);
    size_t size = fread(text, 1, (1 << 20) - 1, file);
    fclose(file);
    assert_true(size < (1 << 20) - 1);
    return text;
}

/* The first error in the validator's report that is not harmless; "" for none. */
static void find_error(const char *path, char *code, size_t capacity)
{
    char report[1200];
    snprintf(report, sizeof report, "%s.report.json", path);
    code[0] = '\0';
    char *text = read_text(report);
    if (text == NULL)
        return;
    cJSON *root = cJSON_Parse(text);
    cJSON *message;
    cJSON_ArrayForEach(message,
                       cJSON_GetObjectItem(cJSON_GetObjectItem(root, "issues"), "messages"))
    {
        const char *found = cJSON_GetStringValue(cJSON_GetObjectItem(message, "code"));
        bool error = cJSON_GetNumberValue(cJSON_GetObjectItem(message, "severity")) == 0;
        for (size_t i = 0; i < sizeof harmless / sizeof harmless[0]; i++)
            error = error && strcmp(harmless[i], found) != 0;
        if (error)
            snprintf(code, capacity, "%s", found);
    }
    cJSON_Delete(root);
    free(text);
}

typedef struct tally {
    int files;
    int loaded;
} tally;

static void try_file(const char *path, tally *tally)
{
    char code[96];
    bb_scene *scene = NULL;
    bb_status status = bb_scene_load(path, &scene);
    find_error(path, code, sizeof code);
    tally->files++;
    if (status == BB_OK) {
        tally->loaded++;
        if (code[0] != '\0')
            fail_msg("%s was read, but the validator says %s", path, code);
        assert_true(scene->prim_count > 0 && scene->view_count >= 3);
    } else {
        assert_null(scene);
        assert_non_null(strstr(bb_message(), path));
        assert_null(strchr(bb_message(), '\n'));
    }
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

static void test_corpus(void **state)
{
    (void)state;
    struct stat info;
    if (stat(CORPUS, &info) != 0) {
        print_message("skipped: there is no %s\n", CORPUS);
        skip();
    }
    tally tally = {0};
    walk(CORPUS, &tally);
    print_message("%d files, %d of them scenes\n", tally.files, tally.loaded);
    assert_true(tally.files >= 200 && tally.loaded >= 30);
}

/* Words that must be in the message for files that are damaged in one known way. */
static void test_messages(void **state)
{
    (void)state;
    static const struct {
        const char *file;
        const char *words;
    } cases[] = {
        {"gltf_validator/glb/empty_file.glb", "empty"},
        {"gltf_validator/glb/no_header.glb", "not binary glTF"},
        {"gltf_validator/glb/invalid_version.glb", "version"},
        {"gltf_validator/glb/truncated_chunk_data.glb", "truncated"},
        {"gltf_validator/glb/truncated_chunk_header.glb", "truncated"},
        {"gltf_validator/glb/only_bin_chunk.glb", "out of place"},
        {"gltf_validator/glb/two_valid_json_chunks.glb", "out of place"},
        {"gltf_validator/node/node_loop.gltf", "cycle"},
        {"gltf_validator/buffer/not_found.gltf", "No such file"},
        {"assimp/glTF2/RecursiveNodes/RecursiveNodes.gltf", "cycle"},
        {"assimp/glTF2/IndexOutOfRange/IndexOutOfRange.gltf", "index 0 is 255"},
        {"assimp/glTF2/BoxWithInfinites-glTF-Binary/BoxWithInfinites.glb",
         "vertex 0 is not finite"},
        {"assimp/glTF2/MissingBin/BoxTextured.gltf", "BoxTextured0.bin"},
        {"trimesh/empty_nodes.glb", "no triangle"},
    };
    struct stat info;
    if (stat(CORPUS, &info) != 0) {
        print_message("skipped: there is no %s\n", CORPUS);
        skip();
    }
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char path[1024];
        snprintf(path, sizeof path, "%s/%s", CORPUS, cases[i].file);
        expect_failure(path, BB_INVALID, cases[i].words);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_corpus),
        cmocka_unit_test(test_messages),
    };
    return cmocka_run_group_tests_name("gltf_corpus", tests, NULL, NULL);
}
