/* The device layer: shared structs, accounts and refusals, programs, edit-and-run. */
#include "framework/base/limits.h"
#include "kernels/bb_shared.h"
#include "tests/device_fixture.h"

#include <dirent.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void structs_have_one_size_everywhere(void **state)
{
    (void)state;
    static const bb_source source = {
        .name = "sizes.cl",
        .text = "#include \"bb_device.h\"\n"
                "kernel void sizes(global uint *out) {\n"
                "  out[0] = sizeof(bb_box); out[1] = sizeof(bb_node);\n"
                "  out[2] = sizeof(bb_tree_info); out[3] = sizeof(bb_ray);\n"
                "  out[4] = sizeof(bb_hit); out[5] = sizeof(bb_count);\n"
                "  out[6] = sizeof(bb_pair); out[9] = sizeof(bb_subtree);\n"
                "  out[10] = sizeof(bb_wide4); out[11] = sizeof(bb_wide8);\n"
                "  out[12] = sizeof(bb_quant8); out[14] = sizeof(bb_cwbvh);\n"
                "  global bb_cwbvh *c = 0; out[15] = (uint)(ulong)&c->planes[0];\n"
                "  global bb_quant8 *q = 0; out[13] = (uint)(ulong)&q->places;\n"
                "  global bb_node *n = 0; out[7] = (uint)(ulong)&n->skip;\n"
                "  global bb_pair *p = 0; out[8] = (uint)(ulong)&p->links[0];\n"
                "}\n"};
    const uint32_t expected[] = {sizeof(bb_box),           sizeof(bb_node),
                                 sizeof(bb_tree_info),     sizeof(bb_ray),
                                 sizeof(bb_hit),           sizeof(bb_count),
                                 sizeof(bb_pair),          offsetof(bb_node, skip),
                                 offsetof(bb_pair, links), sizeof(bb_subtree),
                                 sizeof(bb_wide4),         sizeof(bb_wide8),
                                 sizeof(bb_quant8),        offsetof(bb_quant8, places),
                                 sizeof(bb_cwbvh),         offsetof(bb_cwbvh, planes)};
    uint32_t found[16] = {0};
    cl_program program = NULL;
    cl_kernel kernel = NULL;
    bb_buffer out = {0};
    assert_int_equal(bb_program_build(device, &source, "", &program), BB_OK);
    assert_int_equal(bb_kernel_get(program, "sizes", &kernel), BB_OK);
    assert_int_equal(bb_buffer_reserve(device, NULL, sizeof found, "sizes", &out), BB_OK);
    assert_int_equal(bb_launch(device, kernel, 1, 1, BB_MEM(out)), BB_OK);
    assert_int_equal(bb_buffer_read(&out, 0, sizeof found, found), BB_OK);
    assert_memory_equal(found, expected, sizeof expected);
    bb_buffer_release(&out);
    bb_kernel_release(kernel);
    bb_program_release(program);
}

static void contraction_is_off(void **state)
{
    (void)state;
    /* (1 + 2^-12)^2 - (1 + 2^-11) is 0 when the product is rounded first, 2^-24 when it is not */
    static const bb_source source = {
        .name = "contract.cl",
        .text = "#include \"bb_device.h\"\n"
                "kernel void contract(global float *v) { v[3] = v[0] * v[1] - v[2]; }\n"};
    float v[4] = {1.0f + 0x1p-12f, 1.0f + 0x1p-12f, 1.0f + 0x1p-11f, 7.0f};
    cl_program program = NULL;
    cl_kernel kernel = NULL;
    bb_buffer buffer = {0};
    assert_int_equal(bb_program_build(device, &source, "", &program), BB_OK);
    assert_int_equal(bb_kernel_get(program, "contract", &kernel), BB_OK);
    assert_int_equal(bb_buffer_reserve(device, NULL, sizeof v, "v", &buffer), BB_OK);
    assert_int_equal(bb_buffer_write(&buffer, 0, sizeof v, v), BB_OK);
    assert_int_equal(bb_launch(device, kernel, 1, 1, BB_MEM(buffer)), BB_OK);
    assert_int_equal(bb_buffer_read(&buffer, 0, sizeof v, v), BB_OK);
    assert_true(v[3] == 0.0f);
    bb_buffer_release(&buffer);
    bb_kernel_release(kernel);
    bb_program_release(program);
}

static void accounts_keep_book(void **state)
{
    (void)state;
    bb_account account = {0};
    bb_buffer a = {0};
    void *b = NULL;
    uint64_t before = device->bytes;
    assert_int_equal(bb_buffer_reserve(device, &account, 1000, "a", &a), BB_OK);
    assert_int_equal(bb_host_alloc(&account, 500, "b", &b), BB_OK);
    assert_int_equal(account.bytes, 1500);
    assert_int_equal(bb_buffer_reserve(device, &account, 800, "a", &a), BB_OK);
    assert_int_equal(account.bytes, 1500);
    assert_int_equal(bb_host_alloc(&account, 700, "b", &b), BB_OK);
    assert_int_equal(account.bytes, 1700);
    bb_host_free(b);
    assert_int_equal(account.peak, 1700);
    bb_account_mark(&account);
    assert_int_equal(account.peak, 1000);
    bb_buffer_release(&a);
    assert_int_equal(account.bytes, 0);
    assert_int_equal(device->bytes, before);
}

/* A block that shrinks keeps its beginning and its account; without room for both it stays. */
static void blocks_shrink(void **state)
{
    (void)state;
    bb_account account = {0, 0};
    bb_account *all = bb_host_account();
    const uint64_t before = all->bytes, most = bb_host_most();
    unsigned char *block = NULL;
    ASSERT_OK(bb_host_alloc(&account, 10000, "block", &block));
    for (uint32_t i = 0; i < 10000; i++)
        block[i] = (unsigned char)(i % 251);
    const unsigned char *old = block;
    const uint64_t room = most - all->bytes;
    bb_host_book(room);
    bb_host_shrink(&block, 77);
    assert_ptr_equal(block, old);
    assert_int_equal(account.bytes, 10000);
    assert_int_equal(bb_host_missing(), 0);
    bb_host_unbook(room);
    bb_host_shrink(&block, 77);
    assert_int_equal(account.bytes, 77);
    assert_int_equal(all->bytes, before + 77);
    assert_int_equal((uintptr_t)block % 64, 0);
    for (uint32_t i = 0; i < 77; i++)
        assert_int_equal(block[i], i % 251);
    unsigned char sum = 0; /* 16 bytes more may be read */
    for (uint32_t i = 77; i < 77 + 16; i++)
        sum = (unsigned char)(sum + *(volatile unsigned char *)&block[i]);
    (void)sum;
    bb_host_free(block);
    assert_int_equal(account.bytes, 0);
}

/* Host memory and the buffers of a device that shares it are one account, whoever books them. */
static void one_account_has_all(void **state)
{
    (void)state;
    bb_account *all = bb_host_account();
    const uint64_t before = all->bytes, limit = bb_memory_limit(), most = limit - limit / 16;
    const uint64_t shared = device->is_cpu ? 1000 : 0;
    bb_buffer a = {0};
    void *b = NULL;
    ASSERT_OK(bb_buffer_reserve(device, NULL, 1000, "a", &a));
    ASSERT_OK(bb_host_alloc(NULL, 500, "b", &b));
    assert_int_equal(all->bytes, before + 500 + shared);
    bb_account_mark(all);
    bb_host_book(7000);
    bb_host_unbook(7000);
    assert_int_equal(all->peak, before + 7500 + shared);
    assert_int_equal(bb_host_missing(), 0);
    ASSERT_OK(bb_host_has_room(most - all->bytes, "the thing"));
    assert_int_equal(bb_host_has_room(most - all->bytes + 3, "the thing"), BB_REFUSED);
    assert_non_null(strstr(bb_message(), "the thing"));
    assert_int_equal(bb_host_missing(), 3);
    assert_int_equal(bb_host_missing(), 0);
    bb_host_free(b);
    if (device->is_cpu) { /* what the host lacks, its device lacks */
        const uint64_t room = most - all->bytes;
        bb_host_book(room);
        assert_int_equal(bb_device_has_room(device, 1, "the thing"), BB_REFUSED);
        bb_host_unbook(room);
    }
    bb_buffer_release(&a);
    assert_int_equal(all->bytes, before);
}

static void refuses_before_the_driver_is_asked(void **state)
{
    (void)state;
    bb_buffer buffer = {0};
    size_t largest = device->largest_allocation;
    assert_int_equal(bb_buffer_reserve(device, NULL, largest + 1, "the thing", &buffer),
                     BB_REFUSED);
    char bytes[32];
    snprintf(bytes, sizeof bytes, "%zu", largest + 1);
    assert_non_null(strstr(bb_message(), "the thing"));
    assert_non_null(strstr(bb_message(), bytes));
    assert_null(buffer.mem);
    const uint64_t in_use = device->bytes, global = device->global_bytes, all = bb_memory_limit();
    const bool is_cpu = device->is_cpu;
    for (int own = 0; own < 2; own++) { /* what bounds it: the device, or a limit of the process */
        device->is_cpu = true;
        device->global_bytes = all - (uint64_t)own;
        device->bytes = device->global_bytes - 100;
        assert_int_equal(bb_buffer_reserve(device, NULL, 101, "the thing", &buffer), BB_REFUSED);
        assert_non_null(strstr(bb_message(), own ? device->name : bb_memory_limit_by()));
    }
    device->is_cpu = is_cpu;
    device->global_bytes = global;
    device->bytes = in_use;
    void *host = NULL;
    assert_int_equal(bb_host_alloc(NULL, (size_t)1 << 62, "too much", &host), BB_REFUSED);
    assert_null(host);
}

/* Each of PoCL's threads has a core of its own: if two are woken on one, a launch takes twice as
 * long. */
static void threads_of_the_driver_keep_apart(void **state)
{
    (void)state;
    cpu_set_t all, taken;
    const struct dirent *entry;
    int alone = 0;
    if (strncmp(device->name, "pthread", 7) != 0 && strncmp(device->name, "cpu", 3) != 0)
        skip(); /* not PoCL */
    assert_int_equal(sched_getaffinity(0, sizeof all, &all), 0);
    if ((uint32_t)CPU_COUNT(&all) != bb_core_count() || !CPU_ISSET(bb_core_count() - 1, &all))
        skip(); /* not all cores may be used */
    CPU_ZERO(&taken);
    DIR *tasks = opendir("/proc/self/task");
    assert_non_null(tasks);
    while ((entry = readdir(tasks)) != NULL) {
        cpu_set_t own;
        const pid_t id = (pid_t)strtol(entry->d_name, NULL, 10);
        if (id == 0 || sched_getaffinity(id, sizeof own, &own) != 0 || CPU_COUNT(&own) != 1)
            continue;
        alone++;
        CPU_OR(&taken, &taken, &own);
    }
    closedir(tasks);
    if (CPU_COUNT(&all) > 1)
        assert_int_equal(alone, CPU_COUNT(&all));
    assert_true(CPU_EQUAL(&taken, &all));
}

static void unknown_devices_are_refused(void **state)
{
    (void)state;
    bb_device *none = NULL;
    assert_int_equal(bb_device_open("no such device", BB_FORM_AUTO, NULL, &none), BB_INVALID);
    assert_int_equal(bb_device_open("99", BB_FORM_AUTO, NULL, &none), BB_INVALID);
    assert_null(none);
}

static void a_system_without_sysfs_is_refused(void **state)
{
    (void)state;
    ASSERT_OK(bb_device_check_system("/sys/devices/system/cpu"));
    assert_int_equal(bb_device_check_system("/nonexistent/cpu"), BB_INVALID);
    assert_non_null(strstr(bb_message(), "no /nonexistent/cpu"));
    assert_non_null(strstr(bb_message(), "mount sysfs"));
}

static void build_errors_are_one_line(void **state)
{
    (void)state;
    static const bb_source source = {
        .name = "broken.cl", .text = "kernel void broken(global int *v) { v[0] = nothing; }\n"};
    cl_program program = NULL;
    assert_int_equal(bb_program_build(device, &source, "", &program), BB_FAILED);
    assert_non_null(strstr(bb_message(), "broken.cl"));
    assert_non_null(strstr(bb_message(), "nothing"));
    assert_null(strchr(bb_message(), '\n'));
    assert_null(program);
}

/* `args` to kernel two(global uint *v, uint n): what the refusal says, and that it does not run. */
static void expect_refused(cl_kernel two, size_t local, const bb_arg *args, uint32_t count,
                           const char *part)
{
    assert_int_equal(bb_launch_args(device, two, 1, local, args, count), BB_FAILED);
    if (strstr(bb_message(), part) == NULL || strstr(bb_message(), "kernel two") == NULL)
        fail_msg("expected '%s' in '%s'", part, bb_message());
}

static void launch_errors_name_the_kernel(void **state)
{
    (void)state;
    static const bb_source source = {.name = "two.cl",
                                     .text =
                                         "kernel __attribute__((reqd_work_group_size(1, 1, 1)))\n"
                                         "void two(global uint *v, uint n) { v[0] = n; }\n"};
    cl_program program = NULL;
    cl_kernel two = NULL;
    bb_buffer out = {0};
    uint32_t n = 7, got = 0;
    uint64_t wide = 8;
    assert_int_equal(bb_program_build(device, &source, "", &program), BB_OK);
    assert_int_equal(bb_kernel_get(program, "two", &two), BB_OK);
    assert_int_equal(bb_buffer_reserve(device, NULL, sizeof got, "out", &out), BB_OK);
    assert_int_equal(bb_launch(device, two, 1, 1, BB_MEM(out), BB_VALUE(n)), BB_OK);
    const bb_arg args[] = {BB_MEM(out), BB_VALUE(n), BB_VALUE(n)};
    n = 9; /* a launch with the argument of the one before would write 7 */
    expect_refused(two, 1, args, 1, "takes 2 arguments, 1 were given");
    expect_refused(two, 1, args, 3, "takes 2 arguments, 3 were given");
    const bb_arg too_wide[] = {BB_MEM(out), BB_VALUE(wide)};
    expect_refused(two, 1, too_wide, 2, "argument 1 (from 0) of kernel two, of 8 bytes");
    expect_refused(two, 2, args, 2, "launching kernel two on");
    assert_int_equal(bb_launch_args(device, two, 1, device->max_group_size + 1, args, 2),
                     BB_UNSUPPORTED);
    assert_non_null(strstr(bb_message(), "kernel two needs groups of "));
    assert_int_equal(bb_buffer_read(&out, 0, sizeof got, &got), BB_OK);
    assert_int_equal(got, 7);
    bb_buffer_release(&out);
    bb_kernel_release(two);
    bb_program_release(program);
}

/* A folder's own header, and one of kernels/, by their names; nobody else's. */
static void headers_resolve_within_a_folder(void **state)
{
    (void)state;
    static const char text[] = "#include \"bb_device.h\"\n"
                               "#include \"mine_shared.h\"\n"
                               "kernel void mine(global uint *v) { v[0] = MINE; }\n";
    static const bb_source files[] = {
        {"mine.cl", text, files}, {"mine_shared.h", "#define MINE 42\n", files}, {.name = NULL}};
    const bb_source outside = {.name = "mine.cl", .text = text};
    cl_program program = NULL;
    assert_int_equal(bb_program_build(device, &files[0], "", &program), BB_OK);
    bb_program_release(program);
    bb_programs_clear(device);
    program = NULL;
    assert_int_equal(bb_program_build(device, &outside, "", &program), BB_FAILED);
    assert_non_null(strstr(bb_message(), "mine_shared.h"));
}

static void expect_error(const bb_source *source, const char *words)
{
    cl_program program = NULL;
    assert_int_equal(bb_program_build(device, source, "", &program), BB_FAILED);
    if (strstr(bb_message(), words) == NULL)
        fail_msg("expected '%s' in '%s'", words, bb_message());
}

/* One line names the first error, and a file that has all of them. */
static void all_errors_are_in_a_file(void **state)
{
    (void)state;
    static const bb_source one = {.name = "one.cl", .text = "wrong x;\n"};
    static const bb_source source = {.name = "several.cl", .text = "wrong x;\n\nworse y;\n"};
    char folder[] = "/tmp/bvhbench-log-XXXXXX", log[4096] = "";
    assert_non_null(mkdtemp(folder));
    setenv("TMPDIR", folder, 1);
    expect_error(&one, "one.cl:1:1: ");
    assert_null(strstr(bb_message(), folder));
    for (int again = 0; again < 2; again++) { /* which is compiled once */
        expect_error(&source, "several.cl:1:1: ");
        char *path = strstr(bb_message(), folder);
        if (path == NULL)
            fail_msg("%s", bb_message());
        assert_non_null(strstr(bb_message(), " (2 errors: "));
        path = strndup(path, strcspn(path, ")"));
        FILE *file = fopen(path, "r");
        assert_true(file != NULL || again == 1);
        if (file != NULL) {
            assert_true(fread(log, 1, sizeof log - 1, file) > 0);
            fclose(file);
            unlink(path);
        }
        free(path);
    }
    assert_non_null(strstr(log, "several.cl:3:1: "));
    assert_int_equal(rmdir(folder), 0);
    /* where no file can be made, there is the line alone */
    bb_programs_clear(device);
    expect_error(&source, "several.cl:1:1: ");
    assert_null(strstr(bb_message(), "errors: "));
}

/* The compiler sees one text, and speaks of files and their lines. */
static void errors_name_the_file_and_its_line(void **state)
{
    (void)state;
    static const char above[] = "#include \"bb_device.h\"\n\n\t#  include \"mine.clh\" /* both\n"
                                "*/ kernel void mine(global uint *v) { v[0] = MINE; }\n"
                                "wrong";
    static const char within[] = "#include \"mine.clh\"\nkernel void mine(void) {}\n";
    static const bb_source files[] = {{"mine.cl", above, files},
                                      {"within.cl", within, files},
                                      {"mine.clh", "#define MINE 42", files},
                                      {.name = NULL}};
    static const bb_source bad[] = {
        {"within.cl", within, bad}, {"mine.clh", "\n\nwrong", bad}, {.name = NULL}};
    static const bb_source circle[] = {
        {"within.cl", within, circle}, {"mine.clh", within, circle}, {.name = NULL}};
    cl_program program = NULL;
    expect_error(&files[0], "mine.cl:5:1: ");
    assert_int_equal(bb_program_build(device, &files[1], "", &program), BB_OK);
    bb_program_release(program);
    bb_programs_clear(device);
    expect_error(&bad[0], "mine.clh:3:1: ");
    expect_error(&circle[0], "compiling within.cl: mine.clh includes itself");
}

static void a_folder_overrides_embedded_sources(void **state)
{
    (void)state;
    char folder[] = "/tmp/bvhbench-kernels-XXXXXX", path[128];
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/answer.cl", folder);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs("kernel void answer(global int *v) { v[0] = 42; }\n", file);
    fclose(file);

    static const bb_source source = {.name = "answer.cl",
                                     .text = "kernel void answer(global int *v) { v[0] = 1; }\n"};
    bb_device *other = NULL;
    cl_program program = NULL;
    cl_kernel kernel = NULL;
    bb_buffer out = {0};
    int32_t answer = 0;
    assert_int_equal(open_test_device(BB_FORM_AUTO, "/no/such/folder", &other), BB_INVALID);
    assert_int_equal(open_test_device(BB_FORM_AUTO, folder, &other), BB_OK);
    assert_string_equal(other->sources, "embedded");
    assert_int_equal(bb_program_build(other, &source, "", &program), BB_OK);
    assert_string_equal(other->sources, "folder");
    assert_int_equal(bb_kernel_get(program, "answer", &kernel), BB_OK);
    assert_int_equal(bb_buffer_reserve(other, NULL, sizeof answer, "answer", &out), BB_OK);
    assert_int_equal(bb_launch(other, kernel, 1, 1, BB_MEM(out)), BB_OK);
    assert_int_equal(bb_buffer_read(&out, 0, sizeof answer, &answer), BB_OK);
    assert_int_equal(answer, 42);
    bb_buffer_release(&out);
    bb_kernel_release(kernel);
    bb_program_release(program);
    bb_device_close(other);
    unlink(path);
    rmdir(folder);
}

/* ---- hand-over ---- */

/* A litmus test in which every message comes late: the device must not use the fence, and must say
 * so. */
static void a_fence_that_fails_is_not_used(void **state)
{
    (void)state;
    bb_device *other = NULL;
    if (device->fence[0] == '\0') {
        assert_int_equal(device->handover, BB_HANDOVER_LEVELS);
        assert_int_equal(device->litmus_pairs, 0);
        assert_int_equal(bb_device_set_handover(device, BB_HANDOVER_FENCE), BB_INVALID);
        return;
    }
    assert_true(device->litmus_pairs > 0);
    char folder[] = "/tmp/bvhbench-kernels-XXXXXX", path[128];
    const char *text = bb_source_find("litmus.cl")->text;
    const char *write = strstr(text, "mine[w] = stamp;");
    assert_non_null(write);
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/litmus.cl", folder);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fwrite(text, 1, (size_t)(write - text), file);
    fputs("mine[w] = 0u;", file);
    fputs(write + strlen("mine[w] = stamp;"), file);
    fclose(file);
    assert_int_equal(open_test_device(BB_FORM_AUTO, folder, &other), BB_OK);
    assert_int_equal(other->handover, BB_HANDOVER_LEVELS);
    assert_int_equal(other->litmus_stale, 8 * other->litmus_pairs);
    assert_int_equal(bb_device_set_handover(other, BB_HANDOVER_LEVELS), BB_OK);
    assert_int_equal(bb_device_set_handover(other, BB_HANDOVER_FENCE), BB_INVALID);
    assert_non_null(strstr(bb_message(), "came late"));
    bb_device_close(other);
    unlink(path);
    rmdir(folder);
}

/* A process that ended before its device had would crash in the driver's threads. */
static void closing_waits_for_what_was_enqueued(void **state)
{
    (void)state;
    static const bb_source source = {.name = "long.cl",
                                     .text = "kernel void run(global uint *v, uint count) {\n"
                                             "  uint x = v[0];\n"
                                             "  for (uint i = 0; i < count; i++)\n"
                                             "    x ^= x << 13, x ^= x >> 17, x ^= x << 5;\n"
                                             "  v[0] = x;\n"
                                             "}\n"};
    bb_device *other = NULL;
    cl_program program = NULL;
    cl_kernel kernel = NULL;
    bb_buffer buffer = {0};
    uint32_t value = 1, count = 1u << 26;
    cl_event done = NULL;
    cl_int execution = CL_QUEUED;
    assert_int_equal(open_test_device(BB_FORM_AUTO, NULL, &other), BB_OK);
    assert_int_equal(bb_program_build(other, &source, "", &program), BB_OK);
    assert_int_equal(bb_kernel_get(program, "run", &kernel), BB_OK);
    assert_int_equal(bb_buffer_reserve(other, NULL, sizeof value, "value", &buffer), BB_OK);
    assert_int_equal(bb_buffer_write(&buffer, 0, sizeof value, &value), BB_OK);
    assert_int_equal(bb_launch(other, kernel, 1, 1, BB_MEM(buffer), BB_VALUE(count)), BB_OK);
    assert_int_equal(clEnqueueMarkerWithWaitList(other->queue, 0, NULL, &done), CL_SUCCESS);
    bb_buffer_release(&buffer);
    bb_kernel_release(kernel);
    bb_program_release(program);
    bb_device_close(other);
    assert_int_equal(
        clGetEventInfo(done, CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof execution, &execution, NULL),
        CL_SUCCESS);
    assert_int_equal(execution, CL_COMPLETE);
    clReleaseEvent(done);
}

int main(void)
{
    setenv("TMPDIR", "/nonexistent", 1); /* logs of what does not compile are left nowhere */
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(structs_have_one_size_everywhere),
        cmocka_unit_test(contraction_is_off),
        cmocka_unit_test(accounts_keep_book),
        cmocka_unit_test(blocks_shrink),
        cmocka_unit_test(one_account_has_all),
        cmocka_unit_test(refuses_before_the_driver_is_asked),
        cmocka_unit_test(threads_of_the_driver_keep_apart),
        cmocka_unit_test(unknown_devices_are_refused),
        cmocka_unit_test(a_system_without_sysfs_is_refused),
        cmocka_unit_test(build_errors_are_one_line),
        cmocka_unit_test(launch_errors_name_the_kernel),
        cmocka_unit_test(headers_resolve_within_a_folder),
        cmocka_unit_test(errors_name_the_file_and_its_line),
        cmocka_unit_test(all_errors_are_in_a_file),
        cmocka_unit_test(a_folder_overrides_embedded_sources),
        cmocka_unit_test(a_fence_that_fails_is_not_used),
        cmocka_unit_test(closing_waits_for_what_was_enqueued),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
