/* Rays out, hits in, from outside: `bvhbench rays`, the example of an outside tracer, `bvhbench
 * judge`. */
#include "framework/workload/exchange.h"
#include "tests/program_fixture.h"

#include <cjson/cJSON.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <xxhash.h>

static void trace(const char *arguments)
{
    const outcome *o = run_program("", BB_TEST_OUTSIDE_TRACER, arguments);
    if (o->exit_status != 0 || !(atof(o->out) > 0))
        fail_msg("outside_tracer %s: exit %d, %s%s", arguments, o->exit_status, o->out, o->err);
}

static void make_rays(const char *scene, const char *rays, const char *file)
{
    char arguments[512];
    snprintf(arguments, sizeof arguments,
             "rays --scene %s --rays %s --size 64x64 --max-rays 3000 --out %s", scene, rays, file);
    expect(0, arguments, file);
}

static bool exists(const char *name)
{
    char path[512];
    struct stat info;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return stat(path, &info) == 0;
}

/* The example is right on all workloads and both kinds of primitives, and has no margin to thank
 * for it. */
static void the_example_is_right(void **state)
{
    (void)state;
    static const char *const scenes[] = {"sphere-mesh:n=8", "spheres:n=300",
                                         "random:n=500,ratio=50"};
    static const char *const workloads[] = {"primary", "ao", "diffuse", "shadow", "random"};
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++)
        for (size_t w = 0; w < sizeof workloads / sizeof workloads[0]; w++) {
            char arguments[512];
            make_rays(scenes[s], workloads[w], "a.rays");
            trace("a.rays a.hits");
            snprintf(arguments, sizeof arguments,
                     "judge --scene %s --rays-file a.rays --hits a.hits", scenes[s]);
            const outcome *o = expect(0, arguments, "wrong ppm          0   [0, ");
            assert_non_null(strstr(o->out, "below 3/n at 95 %"));
            assert_int_equal(strncmp(o->out, "brute-force on ", 15), 0);
        }
}

static void the_careless_one_is_caught(void **state)
{
    (void)state;
    make_rays("sphere-mesh:n=16", "primary", "c.rays");
    trace("c.rays c.hits careless");
    const outcome *o = expect(1, "judge --scene sphere-mesh:n=16 --rays-file c.rays --hits c.hits",
                              "first wrong ray: ");
    const char *ppm = strstr(o->out, "wrong ppm");
    char plain[80] = ""; /* without the commas within numbers */
    double value, low, high;
    for (size_t i = 0, used = 0; ppm[i] != ']' && used + 2 < sizeof plain; i++)
        if (ppm[i] != ',' || ppm[i + 1] == ' ')
            plain[used++] = ppm[i];
    assert_int_equal(sscanf(plain, "wrong ppm %lf [%lf, %lf", &value, &low, &high), 3);
    assert_true(value > 1000 && low > 0.5 * value && low < value && value < high &&
                high < 2 * value);
    expect(1, "judge --scene sphere-mesh:n=16 --rays-file c.rays --hits c.hits --max-wrong-ppm 10",
           "missed");
    expect(0, "judge --scene sphere-mesh:n=16 --rays-file c.rays --hits c.hits --max-wrong-ppm 1e6",
           "missed");
}

static const cJSON *trace_of(const cJSON *results, const char *kernel, const char *view)
{
    const cJSON *item;
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(results, "traces"))
    {
        const char *seen = cJSON_GetStringValue(cJSON_GetObjectItem(item, "view"));
        if (strcmp(cJSON_GetStringValue(cJSON_GetObjectItem(item, "kernel")), kernel) == 0 &&
            seen != NULL && strcmp(seen, view) == 0)
            return item;
    }
    fail_msg("no trace of kernel %s from %s", kernel, view);
    return NULL;
}

/* The rays are those of `run`, and its results and the outside tracer's make one report. */
static void outside_tracers_are_put_beside_ours(void **state)
{
    (void)state;
    make_rays("sphere-mesh:n=8", "primary", "o.rays");
    trace("o.rays o.hits");
    expect(0,
           "judge --scene sphere-mesh:n=8 --rays-file o.rays --hits o.hits --mrays-s 0.125 --name "
           "mine:quality=high --out outside",
           "mine:quality=high on sphere-mesh:n=8");
    expect(0,
           "run --scene sphere-mesh:n=8 --builder null --kernel stack --rays primary,diffuse "
           "--size 64x64 "
           "--max-rays 3000 "
           "--repeats 1 --no-pictures --quiet --out ours",
           "null");
    cJSON *ours = read_results("ours/results.json"), *theirs = read_results("outside/results.json");
    const cJSON *outside = trace_of(theirs, "outside", "three-quarter");
    const char *hash = cJSON_GetStringValue(cJSON_GetObjectItem(outside, "rays_hash"));
    assert_string_equal(hash, cJSON_GetStringValue(cJSON_GetObjectItem(
                                  trace_of(ours, "stack", "three-quarter"), "rays_hash")));
    assert_string_equal(cJSON_GetStringValue(cJSON_GetObjectItem(outside, "builder")),
                        "mine:quality=high");
    assert_true(cJSON_GetNumberValue(cJSON_GetObjectItem(outside, "mrays_s")) == 0.125);
    assert_true(cJSON_GetNumberValue(cJSON_GetObjectItem(outside, "mrays_s_given")) == 0.125);
    assert_true(cJSON_IsNull(cJSON_GetObjectItem(outside, "ms")));
    assert_false(cJSON_IsTrue(cJSON_GetObjectItem(outside, "wrong")));
    assert_true(cJSON_GetNumberValue(cJSON_GetObjectItem(cJSON_GetObjectItem(outside, "accuracy"),
                                                         "checked")) == 64 * 64);
    /* sets that are sampled are the same, too */
    const outcome *o = expect(0,
                              "rays --scene sphere-mesh:n=8 --rays diffuse --size 64x64 --max-rays "
                              "3000 --out o2.rays",
                              "; rays ");
    bool found = false;
    const cJSON *item;
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(ours, "traces"))
    {
        const char *name = cJSON_GetStringValue(cJSON_GetObjectItem(item, "rays"));
        hash = cJSON_GetStringValue(cJSON_GetObjectItem(item, "rays_hash"));
        found |= strcmp(name, "diffuse") == 0 && strstr(o->out, hash) != NULL;
    }
    assert_true(found);
    cJSON_Delete(ours);
    cJSON_Delete(theirs);
    expect(0, "report ours outside --out both.html", "both.html");
    static char page[4 << 20];
    read_file("both.html", page, sizeof page);
    assert_non_null(strstr(page, "mine:quality=high"));
    /* without a speed there is none in the record, and the tracer's own name stands */
    expect(0, "judge --scene sphere-mesh:n=8 --rays-file o.rays --hits o.hits --out slow", "right");
    theirs = read_results("slow/results.json");
    outside = trace_of(theirs, "outside", "three-quarter");
    assert_true(cJSON_IsNull(cJSON_GetObjectItem(outside, "mrays_s")));
    assert_string_equal(cJSON_GetStringValue(cJSON_GetObjectItem(outside, "builder")),
                        "brute-force");
    cJSON_Delete(theirs);
    expect(0, "report slow ours --out both.html", "both.html");
}

/* Several views and workloads are one tracer: one build in the record, a trace each. */
static void several_files_are_one_record(void **state)
{
    (void)state;
    expect(0, "rays --scene cube --rays primary --size 32x32 --out m0.rays", "three-quarter");
    expect(0, "rays --scene cube --rays primary --size 32x32 --view back --out m1.rays", "back");
    expect(0, "rays --scene cube --rays ao --max-rays 500 --out m2.rays", "any hit");
    trace("m0.rays m0.hits");
    trace("m1.rays m1.hits");
    trace("m2.rays m2.hits");
    const outcome *o = expect(0,
                              "judge --scene cube --rays-file m0.rays,m1.rays,m2.rays --hits "
                              "m0.hits,m1.hits --hits m2.hits --mrays-s 1,2,3 --out many",
                              "primary from back");
    assert_non_null(strstr(o->out, "primary from three-quarter"));
    assert_non_null(strstr(o->out, "ao, any hit"));
    cJSON *json = read_results("many/results.json");
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(json, "builds")), 1);
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(json, "traces")), 3);
    assert_true(cJSON_GetNumberValue(
                    cJSON_GetObjectItem(trace_of(json, "outside", "back"), "mrays_s")) == 2);
    cJSON_Delete(json);
    /* the same name and view from another seed: of a run of its own, with its tracer */
    expect(0, "rays --scene cube --rays ao --max-rays 500 --seed 2 --out m3.rays", "any hit");
    trace("m3.rays m3.hits");
    expect(0,
           "judge --scene cube --rays-file m2.rays,m3.rays,m0.rays --hits m2.hits,m3.hits,m0.hits "
           "--mrays-s 1,2,3 --out seeds",
           "ao, any hit");
    json = read_results("seeds/results.json");
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(json, "builds")), 2);
    const cJSON *rows = cJSON_GetObjectItem(json, "traces");
    assert_int_equal(cJSON_GetArraySize(rows), 3);
    for (int i = 0; i < 3; i++) {
        const cJSON *row = cJSON_GetArrayItem(rows, i);
        assert_true(cJSON_GetNumberValue(cJSON_GetObjectItem(row, "mrays_s")) == i + 1);
        assert_true(cJSON_GetNumberValue(cJSON_GetObjectItem(row, "run")) == (i > 0));
    }
    cJSON_Delete(json);
    refuses("", "judge --scene cube --rays-file m0.rays,m1.rays --hits m0.hits",
            "same number of both");
    refuses("", "judge --scene cube --rays-file m0.rays,m0.rays --hits m0.hits,m0.hits",
            "same rays");
    refuses("", "judge --scene cube --rays-file m0.rays,m1.rays --hits m1.hits,m0.hits",
            "other rays");
    refuses("", "judge --scene cube --rays-file m0.rays,m1.rays --hits m0.hits,m1.hits --mrays-s 1",
            "--mrays-s");
}

static void the_same_command_writes_the_same_file(void **state)
{
    (void)state;
    static char first[1 << 20], second[1 << 20];
    make_rays("random:n=100", "random", "s.rays");
    size_t size = read_file("s.rays", first, sizeof first);
    make_rays("random:n=100", "random", "s.rays");
    assert_int_equal(read_file("s.rays", second, sizeof second), size);
    assert_memory_equal(first, second, size);
    expect(0, "rays --scene random:n=100 --rays random --max-rays 3000 --seed 2 --out s.rays", "");
    assert_int_equal(read_file("s.rays", second, sizeof second), size);
    assert_memory_not_equal(first + 1024, second + 1024, 3000 * 32);
    expect(0, "rays --scene cube --rays primary --size 8x4 --view back --out s.rays", "from back");
}

static void bad_requests_are_refused(void **state)
{
    (void)state;
    make_rays("cube", "primary", "b.rays");
    make_rays("cube", "random", "other.rays");
    trace("b.rays b.hits");
    trace("other.rays other.hits");
    refuses("", "rays --scene cube --rays primary", "--out");
    refuses("", "rays --scene cube --out x.rays", "--rays");
    refuses("", "rays --rays primary --out x.rays", "--scene");
    refuses("", "rays --scene cube --rays gamma --out x.rays", "gamma");
    refuses("", "rays --scene cube --rays primary:tmin=a --out x.rays", "tmin");
    refuses("", "rays --scene missing.glb --rays primary --out x.rays", "missing.glb");
    refuses("", "rays --scene cube --rays primary --view behind --out x.rays", "behind");
    refuses("", "rays --scene cube --rays diffuse --view back --out x.rays", "--view");
    refuses("", "rays --scene cube --rays random --max-rays 0 --out x.rays", "--max-rays");
    refuses("", "rays --scene coffee --rays edges:from=inside --out x.rays", "closed mesh");
    refuses("", "rays --scene cube --rays primary --out /dev/null/x.rays", "/dev/null");
    refuses("", "rays --scene cube --rays primary --out /dev/null", "/dev/null");
    assert_false(exists("x.rays"));

    refuses("", "judge --scene cube --rays-file b.rays", "--hits");
    refuses("", "judge --scene cube --hits b.hits", "--rays-file");
    refuses("", "judge --scene cube --rays-file b.rays --hits missing", "missing");
    refuses("", "judge --scene cube --rays-file b.hits --hits b.hits", "b.hits");
    refuses("", "judge --scene cube --rays-file b.rays --hits b.rays", "BVHBHITS");
    refuses("", "judge --scene single --rays-file b.rays --hits b.hits", "another scene");
    refuses("", "judge --scene cube --rays-file b.rays --hits other.hits", "other rays");
    refuses("", "judge --scene cube --rays-file b.rays --hits b.hits --mrays-s 0", "--mrays-s");
    refuses("", "judge --scene cube --rays-file b.rays --hits b.hits --mrays-s nan", "--mrays-s");
    refuses("", "judge --scene cube --rays-file b.rays --hits b.hits --name :", "':'");
    refuses("", "judge --scene cube --rays-file b.rays --hits b.hits --out /dev/null/x",
            "/dev/null/x");
}

/* As a shell script would damage them. */
static void damaged_files_are_refused(void **state)
{
    (void)state;
    make_rays("cube", "primary", "d.rays");
    trace("d.rays d.hits");
    static const struct {
        const char *damage, *rays, *hits, *words;
    } cases[] = {
        {"head -c 5000 d.rays >cut.rays", "cut.rays", "d.hits", "truncated"},
        {"head -c -1 d.hits >cut.hits", "d.rays", "cut.hits", "truncated"},
        {"(cat d.hits; echo) >long.hits", "d.rays", "long.hits", "too long"},
        {": >empty.rays", "empty.rays", "d.hits", "empty.rays has 0 bytes"},
        {"(head -c 2000 d.rays; printf '\\377'; tail -c +2002 d.rays) >bit.rays", "bit.rays",
         "d.hits", "damaged"},
        {"(head -c 128 d.hits; printf '\\000\\000\\300\\177'; tail -c +133 d.hits) >nan.hits",
         "d.rays", "nan.hits", "ray 0"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char arguments[512];
        snprintf(arguments, sizeof arguments, "(%s)", cases[i].damage);
        assert_int_equal(run_program("", arguments, "")->exit_status, 0);
        snprintf(arguments, sizeof arguments, "judge --scene cube --rays-file %s --hits %s --out r",
                 cases[i].rays, cases[i].hits);
        refuses("", arguments, cases[i].words);
        assert_false(exists("r/results.json"));
    }
}

/* Writes `to`: the rays of `from` under a changed header, the first `aside` of them turned round,
 * with all hashes right. */
static void forge(const char *from, const char *to, const bb_rays_header *changed, uint32_t aside)
{
    static char bytes[1 << 20];
    size_t size = read_file(from, bytes, sizeof bytes);
    bb_rays_header header = *changed;
    for (uint32_t i = 0; i < aside; i++) {
        bb_ray ray;
        memcpy(&ray, bytes + sizeof header + i * sizeof ray, sizeof ray);
        for (int k = 0; k < 3; k++)
            ray.d[k] = -ray.d[k];
        memcpy(bytes + sizeof header + i * sizeof ray, &ray, sizeof ray);
    }
    header.rays_hash = XXH3_64bits(bytes + sizeof header, header.ray_count * sizeof(bb_ray));
    header.checksum = 0;
    memcpy(bytes, &header, sizeof header);
    header.checksum = XXH3_64bits(bytes, size);
    memcpy(bytes, &header, sizeof header);
    write_file(to, bytes, size);
}

static bb_rays_header header_of(const char *name)
{
    static char bytes[1 << 20];
    bb_rays_header header;
    assert_true(read_file(name, bytes, sizeof bytes) > sizeof header);
    memcpy(&header, bytes, sizeof header);
    return header;
}

/* Judges what the example answers to a.rays: `words` say why not. */
static void refuses_forged(const char *words)
{
    trace("f.rays f.hits");
    refuses("", "judge --scene sphere-mesh:n=8 --rays-file f.rays --hits f.hits", words);
}

/* A file whose hashes are all right, but whose rays are not what it says they are. */
static void forged_labels_are_refused(void **state)
{
    (void)state;
    make_rays("sphere-mesh:n=8", "edges", "e.rays");
    bb_rays_header edges = header_of("e.rays"), changed = edges;
    assert_int_equal(edges.must_hit, 1);
    changed.must_hit = 0; /* a margin for misses */
    forge("e.rays", "f.rays", &changed, 0);
    refuses_forged("must_hit is 0, for rays 'edges' it is 1");
    forge("e.rays", "f.rays", &edges, 1);
    refuses_forged("are not those of 'edges'");
    changed = edges;
    changed.seed++;
    forge("e.rays", "f.rays", &changed, 0);
    refuses_forged("are not those of 'edges'");

    static const char *const workloads[] = {"primary", "ao", "diffuse", "shadow", "random"};
    for (size_t w = 0; w < sizeof workloads / sizeof workloads[0]; w++) {
        make_rays("sphere-mesh:n=8", workloads[w], "h.rays");
        bb_rays_header header = header_of("h.rays");
        forge("h.rays", "f.rays", &header, 1);
        refuses_forged("are not those of");
    }
    changed = header_of("h.rays");
    changed.version = 1;
    forge("h.rays", "f.rays", &changed, 0);
    refuses("", "judge --scene sphere-mesh:n=8 --rays-file f.rays --hits f.hits",
            "f.rays is of version 1, this program reads 4: make rays and hits anew");
}

/* They are judged under a name of their own, and record and report say what they are. */
static void rays_made_by_hand_are_judged_as_given(void **state)
{
    (void)state;
    static char page[4 << 20];
    make_rays("sphere-mesh:n=8", "random", "h.rays");
    bb_rays_header header = header_of("h.rays");
    forge("h.rays", "f.rays", &header, 40);
    trace("f.rays f.hits");
    const char *judge = "judge --scene sphere-mesh:n=8 --rays-file f.rays --hits f.hits --verify ";
    char arguments[512];
    snprintf(arguments, sizeof arguments, "%s%s", judge, "no");
    refuses("", arguments, "'random' names a workload");
    snprintf(arguments, sizeof arguments, "%s%s", judge, "maybe");
    refuses("", arguments, "--verify");

    memset(header.rays, 0, sizeof header.rays);
    snprintf(header.rays, sizeof header.rays, "my-rays");
    header.seed = header.primary_width = header.primary_height = header.max_rays = 0;
    forge("h.rays", "f.rays", &header, 40);
    trace("f.rays f.hits");
    snprintf(arguments, sizeof arguments, "%s%s", judge, "yes");
    refuses("", arguments, "no rays 'my-rays'");
    snprintf(arguments, sizeof arguments, "%s%s", judge, "no --mrays-s 1 --out given");
    expect(0, arguments, "my-rays (rays as given), closest hit: 3000 hits for 3000 rays");
    cJSON *json = read_results("given/results.json");
    const cJSON *trace_record = cJSON_GetArrayItem(cJSON_GetObjectItem(json, "traces"), 0);
    assert_string_equal(cJSON_GetStringValue(cJSON_GetObjectItem(trace_record, "rays_source")),
                        "as given");
    cJSON_Delete(json);
    expect(0, "report given --out given.html", "given.html");
    read_file("given.html", page, sizeof page);
    assert_non_null(strstr(page, "\"rays_source\":\"as given\""));
    make_rays("sphere-mesh:n=8", "random", "a.rays");
    trace("a.rays a.hits");
    expect(0,
           "judge --scene sphere-mesh:n=8 --rays-file a.rays --hits a.hits --out made --history "
           "made.db",
           "right");
    expect(0, "report --history made.db --out made.html", "Z     1 ");
    expect(0, "compare made made", "nothing is worse");
    json = read_results("made/results.json");
    trace_record = cJSON_GetArrayItem(cJSON_GetObjectItem(json, "traces"), 0);
    assert_string_equal(cJSON_GetStringValue(cJSON_GetObjectItem(trace_record, "rays_source")),
                        "workload");
    cJSON_Delete(json);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_example_is_right),
        cmocka_unit_test(the_careless_one_is_caught),
        cmocka_unit_test(outside_tracers_are_put_beside_ours),
        cmocka_unit_test(several_files_are_one_record),
        cmocka_unit_test(the_same_command_writes_the_same_file),
        cmocka_unit_test(bad_requests_are_refused),
        cmocka_unit_test(damaged_files_are_refused),
        cmocka_unit_test(forged_labels_are_refused),
        cmocka_unit_test(rays_made_by_hand_are_judged_as_given),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
