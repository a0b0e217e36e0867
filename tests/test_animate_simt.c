/* `animate --metrics simt`: traces of the first and the last frame on a GPU on paper. */
#include "tests/simulated_rows.h"

#define SIZES "--rays diffuse --size 64x64 --max-rays 4096 --repeats 1 --quiet --seed 5 "
#define SCENE "--scene twist:n=2000,frames=5 "
#define ANIMATE                                                                                    \
    "animate " SCENE SIZES "--builder lbvh,lbvh+refit --kernel stack8,stack8i,stack --json "

static const cJSON *simulated(const cJSON *json, const char *maker, const char *frame,
                              const char *builder, const char *kernel)
{
    const cJSON *row;
    cJSON_ArrayForEach(row, rows_of(json))
    {
        if (strcmp(text_in(row, "maker"), maker) == 0 &&
            strcmp(text_in(row, "frame"), frame) == 0 &&
            strcmp(text_in(row, "builder"), builder) == 0 &&
            strcmp(text_in(row, "intersector"), kernel) == 0)
            return row;
    }
    fail_msg("no row %s, %s, %s, %s", maker, frame, builder, kernel);
    return NULL;
}

/* The first frame is what `run` takes of such a scene. */
static void the_first_frame_is_that_of_run(void **state)
{
    (void)state;
    static const char *const kernels[] = {"stack8", "stack"};
    static const char *const makers[] = {H100, "simt:device=rtx4090,width=64"};
    cJSON *json =
        json_of("POCL_MAX_PTHREAD_COUNT=1", ANIMATE "--metrics simt,simt:device=rtx4090,width=64");
    expect(0,
           "run " SCENE SIZES "--builder lbvh --kernel stack8,stack --no-pictures --charts no "
           "--out ran --metrics simt,simt:device=rtx4090,width=64",
           "");
    cJSON *ran = read_json("ran/results.json");
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 2; i++)
            has_the_same_figures(simulated(json, makers[i], "0", "lbvh", kernels[k]),
                                 run_row(rows_of(ran), makers[i], "lbvh", kernels[k], "diffuse"));
    cJSON_Delete(ran);
    cJSON_Delete(json);
}

/* A tree that is built anew does not know which frames came before; one that was refitted does. */
static void the_last_frame_is_that_of_its_tree(void **state)
{
    (void)state;
    cJSON *all = json_of("", ANIMATE "--metrics simt");
    cJSON *end = json_of("", "animate " SCENE SIZES "--builder lbvh --kernel stack8,stack --json "
                             "--frames 3..4 --metrics simt");
    has_the_same_figures(simulated(all, H100, "4", "lbvh", "stack8"),
                         simulated(end, H100, "4", "lbvh", "stack8"));
    has_the_same_figures(simulated(all, H100, "0", "lbvh+refit", "stack"),
                         simulated(all, H100, "0", "lbvh", "stack"));
    assert_true(number_in(simulated(all, H100, "4", "lbvh+refit", "stack"), "simt_mrays_s") <
                number_in(simulated(all, H100, "4", "lbvh", "stack"), "simt_mrays_s"));
    cJSON_Delete(end);
    cJSON_Delete(all);
}

/* In rows of their own, of two frames; a kernel without recorded steps says so. */
static void only_what_was_simulated_is(void **state)
{
    (void)state;
    cJSON *json = json_of("", ANIMATE "--metrics simt");
    const cJSON *row;
    uint32_t count = 0, left_out = 0;
    cJSON_ArrayForEach(row, rows_of(json))
    {
        const bool of_simulation = strcmp(text_in(row, "maker"), H100) == 0;
        assert_true(of_simulation || !is_simulated(row));
        assert_true(!of_simulation || cJSON_GetObjectItemCaseSensitive(row, "trace_ms") == NULL);
        count += is_simulated(row);
        if (text_in(row, "simt_unsimulated")[0] == '\0')
            continue;
        assert_string_equal(text_in(row, "simt_unsimulated"),
                            "the steps of kernel stack8i are not recorded");
        left_out++;
    }
    assert_int_equal(count, 2 * 2 * 2); /* frames, methods, kernels */
    assert_int_equal(left_out, 2);
    cJSON_Delete(json);
    expect(0,
           "animate --scene twist:n=300,frames=3 --size 16x16 --max-rays 256 --repeats 1 --quiet "
           "--metrics simt",
           "Simulated: neither measured nor validated; first and last frame, " H100);
}

static void what_cannot_be_simulated_is_refused(void **state)
{
    (void)state;
    refuses_bad_simulations("animate --scene twist:n=100");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_first_frame_is_that_of_run),
        cmocka_unit_test(the_last_frame_is_that_of_its_tree),
        cmocka_unit_test(only_what_was_simulated_is),
        cmocka_unit_test(what_cannot_be_simulated_is_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
