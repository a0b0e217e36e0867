/* What a first run on a GPU would find: commands on the mock GPU, in groups of 64, 128 and 256 and
 * with local memory of 16, 32 and 48 KiB, each pair once; without a fence but where one is named.
 * All answers are right, nothing is refused by the driver, and no host memory is mapped. */
#include "tests/mock_fixture.h"

#define FEW " --size 16x16 --max-rays 256 --repeats 1 --no-pictures --charts no --quiet "

/* The command ends well, with `words` on standard output, on the GPU and within its limits. */
static const outcome *works(const char *mock, const char *arguments, const char *words)
{
    const outcome *o = run_with(mock, arguments);
    if (o->exit_status != 0 || strstr(o->out, words) == NULL)
        fail_msg("%s bvhbench %s: exit %d, expected 0 and '%s':\n%s%s", mock, arguments,
                 o->exit_status, words, o->out, o->err);
    if (counted("launches") == 0 || counted("refused") != 0 || counted("maps") != 0)
        fail_msg("%s bvhbench %s: %lu launches, %lu calls refused, %lu maps", mock, arguments,
                 counted("launches"), counted("refused"), counted("maps"));
    return o;
}

static void the_default_comparison(void **state)
{
    (void)state;
    works(MOCK("MOCK_GPU_GROUP=64 MOCK_GPU_LOCAL=32"), "run --scene sphere-mesh:n=12" FEW,
          "no wrong one");
}

static void all_builders(void **state)
{
    (void)state;
    works(MOCK("MOCK_GPU_GROUP=128 MOCK_GPU_LOCAL=32"),
          "check --builder all --scene sphere-mesh:n=12 --scene nbody:n=12", " 0 checks failed");
    const outcome *o = run_with(MOCK("MOCK_GPU_LOCAL=16"), "check --builder bonsai --scene cube");
    assert_int_equal(o->exit_status, 1); /* OpenCL asks for 32 KiB of a device */
    assert_non_null(strstr(o->out, "take 20856 bytes of local memory, and the device has 16384"));
}

static void all_kernels(void **state)
{
    (void)state;
    works(MOCK("MOCK_GPU_GROUP=256 MOCK_GPU_LOCAL=16"),
          "run --scene sphere-mesh:n=12 --builder lbvh --kernel all --rays primary,ao,shadow" FEW,
          "no wrong one");
}

static void moving_scenes(void **state)
{
    (void)state;
    works(MOCK("MOCK_GPU_GROUP=64 MOCK_GPU_LOCAL=48"),
          "animate --scene twist:n=300,frames=3 --size 16x16 --max-rays 256 --repeats 1 --quiet",
          "twist");
}

static void volumes_and_meshes(void **state)
{
    (void)state;
    works(MOCK("MOCK_GPU_GROUP=128 MOCK_GPU_LOCAL=16"),
          "volume --scene nbody:n=16 --scene tets:side=3 --size 16x16 --steps 2 --repeats 1",
          "nbody");
    works(MOCK("MOCK_GPU_GROUP=256 MOCK_GPU_LOCAL=32"),
          "overlap tets:side=3 tets:side=2 --fit 0.5 --repeats 1", "tets");
    works(MOCK("MOCK_GPU_GROUP=64 MOCK_GPU_LOCAL=16"), "slice --scene tets:side=3 --repeats 1",
          "tets");
}

static void fences_in_each_style(void **state)
{
    (void)state;
    static const char check[] = "check --builder lbvh,ploc --scene sphere-mesh:n=12";
    static const char fits[] = " 0 checks failed";
    works(MOCK("MOCK_GPU_GROUP=128 MOCK_GPU_LOCAL=48 MOCK_GPU_FENCE=cl2"), check, fits);
    assert_true(counted("launches litmus") > 0);
    works(MOCK("MOCK_GPU_GROUP=256 MOCK_GPU_LOCAL=48 MOCK_GPU_FENCE=cl3"), check, fits);
    assert_true(counted("launches litmus") > 0);
    works(MOCK("MOCK_GPU_FENCE=old"), check, fits);
    assert_int_equal(counted("launches litmus"), 0);
}

/* A kernel of many registers runs in smaller groups than the device's: whatever kernel, it does so,
 * or says in one line that it was compiled for larger ones. */
static void kernels_of_small_groups(void **state)
{
    (void)state;
    works(MOCK("MOCK_GPU_KERNEL_GROUP=trace:24"),
          "run --scene cube --builder lbvh --kernel stack --kernel stack:persistent=yes "
          "--rays primary" FEW,
          "no wrong one");
    cJSON *results = read_results("out/results.json");
    const cJSON *trace;
    uint32_t traced = 0;
    cJSON_ArrayForEach(trace, cJSON_GetObjectItem(results, "traces"))
    {
        const cJSON *group = cJSON_GetObjectItem(trace, "group_size");
        if (group == NULL || group->valueint == 0)
            continue;                          /* Embree */
        assert_int_equal(group->valueint, 16); /* 64, halved until it is 24 at most */
        traced++;
    }
    cJSON_Delete(results);
    assert_true(traced >= 2);
    works(MOCK("MOCK_GPU_KERNEL_GROUP=code_keys:1"), "check --builder lbvh --scene cube",
          " 0 checks failed");
    const outcome *o = run_with(MOCK("MOCK_GPU_KERNEL_GROUP=hploc_level:16"),
                                "check --builder hploc --scene cube");
    assert_int_equal(o->exit_status, 1);
    assert_non_null(strstr(o->out, "kernel hploc_level needs groups of 32 work-items, and Mock GPU "
                                   "runs it in groups of up to 16"));
}

/* Work-items that co-operate, in a kernel that does not say for how many it is compiled, would make
 * another tree in smaller groups. The scene is large enough for every pass of every builder. */
static void any_group_makes_the_same_trees(void **state)
{
    (void)state;
    works(MOCK("MOCK_GPU_KERNEL_GROUP=*:8"),
          "check --builder all --scene random:n=12000 --scene nbody:n=16", " 0 checks failed");
}

/* Those that trace many rays in a work-item, though the device's groups are small; a group that is
 * given and does not fit is refused. */
static void groups_are_bounded_by_the_device(void **state)
{
    (void)state;
    works(MOCK("MOCK_GPU_GROUP=64"),
          "run --scene cube --builder lbvh --kernel stack8i:group=256 --rays primary" FEW,
          "no wrong one");
    works(MOCK("MOCK_GPU_GROUP=32"),
          "run --scene cube --builder lbvh --kernel stack --rays "
          "primary" FEW,
          "no wrong one");
    refuses(MOCK("MOCK_GPU_GROUP=64"),
            "run --scene cube --builder lbvh --kernel stack:group=128 --rays primary" FEW,
            "a whole number from 1 to 64");
}

static void a_gpu_is_preferred(void **state)
{
    (void)state;
    const outcome *o = run_with(MOCK("MOCK_GPU_DEVICES=cpu,accelerator,gpu"), "list devices");
    const char *gpu = strstr(o->out, " 0 "), *accelerator = strstr(o->out, " 1 "),
               *cpu = strstr(o->out, " 2 ");
    assert_non_null(strstr(gpu, "/ GPU (the default)\n"));
    assert_true(strstr(gpu, "Mock GPU") < accelerator);
    assert_non_null(strstr(accelerator, "Mock accelerator"));
    assert_non_null(strstr(cpu, "/ CPU\n"));
    o = works(MOCK("MOCK_GPU_DEVICES=cpu,gpu"), "check --builder lbvh --scene cube", " 0 checks");
    assert_int_equal(strncmp(o->err, "device: Mock GPU (", 18), 0);
    o = works(MOCK("MOCK_GPU_DEVICES=cpu,accelerator"), "check --builder lbvh --scene cube",
              " 0 checks");
    assert_int_equal(strncmp(o->err, "device: Mock accelerator (", 26), 0);
    o = run_with(MOCK("MOCK_GPU_DEVICES=cpu,gpu"),
                 "check --builder lbvh --scene cube --device 1 --quiet");
    assert_int_equal(o->exit_status, 0);
    assert_string_equal(o->err, "");
    o = works(MOCK("MOCK_GPU_DEVICES=cpu,gpu"),
              "run --scene cube --builder lbvh --kernel stack --rays primary" FEW, "no wrong one");
    assert_int_equal(strncmp(o->out, "Mock GPU\n", 9), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_default_comparison),
        cmocka_unit_test(all_builders),
        cmocka_unit_test(all_kernels),
        cmocka_unit_test(moving_scenes),
        cmocka_unit_test(volumes_and_meshes),
        cmocka_unit_test(fences_in_each_style),
        cmocka_unit_test(kernels_of_small_groups),
        cmocka_unit_test(any_group_makes_the_same_trees),
        cmocka_unit_test(groups_are_bounded_by_the_device),
        cmocka_unit_test(a_gpu_is_preferred),
    };
    return cmocka_run_group_tests_name("mock_gpu", tests, make_folder, remove_folder);
}
