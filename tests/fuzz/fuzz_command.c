/* The whole command line, a word per line: everything that is decided before a device is opened, a
 * scene is loaded or a file is written. These are taken from the program when this is linked
 * (--wrap), and refuse. */
#include "framework/base/variants.h"
#include "framework/cli/cli.h"
#include "framework/device/device.h"
#include "framework/scene/scene.h"
#include "tests/fuzz/fuzz.h"

enum { ARGUMENTS = 48, OUTPUT = 1 << 20 };

#define REFUSED "refused by the target"

bb_status __wrap_bb_device_open(const char *name, bb_form form, const char *folder,
                                bb_device **device);
bb_status __wrap_bb_device_open(const char *name, bb_form form, const char *folder,
                                bb_device **device)
{
    (void)name, (void)form, (void)folder;
    *device = NULL;
    return bb_fail(BB_FAILED, REFUSED);
}

/* One process does it all. */
void __wrap_bb_guard_start(bool again, int exit_died, int exit_cannot);
void __wrap_bb_guard_start(bool again, int exit_died, int exit_cannot)
{
    (void)again, (void)exit_died, (void)exit_cannot;
}

bb_status __wrap_bb_device_count(uint32_t *count);
bb_status __wrap_bb_device_count(uint32_t *count)
{
    *count = 0;
    return bb_fail(BB_FAILED, REFUSED);
}

uint32_t __wrap_bb_device_find_kind(const char *name);
uint32_t __wrap_bb_device_find_kind(const char *name)
{
    (void)name;
    return BB_FOR_CPU;
}

bb_status __wrap_bb_scene_load(const char *text, bb_scene **scene);
bb_status __wrap_bb_scene_load(const char *text, bb_scene **scene)
{
    (void)text;
    *scene = NULL;
    return bb_fail(BB_FAILED, REFUSED);
}

bb_status __wrap_bb_plugin_load(const char *path);
bb_status __wrap_bb_plugin_load(const char *path)
{
    (void)path;
    return bb_fail(BB_FAILED, REFUSED);
}

bb_status __wrap_bb_out_folder(const char *path);
bb_status __wrap_bb_out_folder(const char *path)
{
    (void)path;
    return BB_OK;
}

bb_status __wrap_bb_out_file(const char *path, const char *what);
bb_status __wrap_bb_out_file(const char *path, const char *what)
{
    (void)path;
    (void)what;
    return BB_OK;
}

bb_status __wrap_bb_results_read(const char *path, void **results);
bb_status __wrap_bb_results_read(const char *path, void **results)
{
    (void)path;
    *results = NULL;
    return bb_fail(BB_FAILED, REFUSED);
}

/* Words, from the lines of the input, behind the program's name. */
static int split(char *text, char *arguments[ARGUMENTS])
{
    int count = 0;
    arguments[count++] = "bvhbench";
    while (text != NULL && count < ARGUMENTS - 1)
        arguments[count++] = strsep(&text, "\n");
    arguments[count] = NULL;
    return count;
}

/* Standard output and error, as texts. */
static char out_text[OUTPUT], err_text[OUTPUT];
static FILE *out, *err;

static void open_streams(void)
{
    if (out == NULL) {
        out = fmemopen(out_text, OUTPUT, "w");
        err = fmemopen(err_text, OUTPUT, "w");
        FUZZ_CHECK(out != NULL && err != NULL);
        (void)!chdir(fuzz_path("")); /* nobody's files are read as scenes */
    }
    rewind(out);
    rewind(err);
}

static size_t written(FILE *stream)
{
    FUZZ_CHECK(fflush(stream) == 0);
    return (size_t)ftell(stream);
}

/* Through the standard streams, which are variables in glibc. */
static int run(int count, char **arguments)
{
    FILE *const real_out = stdout, *const real_err = stderr;
    stdout = out;
    stderr = err;
    int status = bb_main(count, arguments);
    stdout = real_out;
    stderr = real_err;
    return status;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *arguments[ARGUMENTS];
    char *text = fuzz_text(data, size);
    int count = split(text, arguments);
    open_streams();
    int status = run(count, arguments);
    size_t said = written(out), complained = written(err);
    if (status == BB_EXIT_OK) {
        FUZZ_CHECK(complained == 0 && said > 0);
    } else {
        FUZZ_CHECK(status == BB_EXIT_CANNOT);
        FUZZ_CHECK(said == 0);
        FUZZ_CHECK(complained > strlen("bvhbench: \n") && err_text[complained - 1] == '\n');
        FUZZ_CHECK(strncmp(err_text, "bvhbench: ", 10) == 0);
        FUZZ_CHECK(memchr(err_text, '\n', complained) == err_text + complained - 1);
    }
    free(text);
    return 0;
}
