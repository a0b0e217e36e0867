/* Codes: their layouts against the definition, and the keys that the device makes against a
 * bit-by-bit reference, for all codes and ingredients, in both forms, with shifts and with tables.
 * Seed: BVHBENCH_TEST_SEED. BVHBENCH_TEST_SMALL keeps the inputs small (for oclgrind). */
#include "builders/common/codes.h"
#include "framework/base/random.h"
#include "framework/builder/phases.h"
#include "tests/device_forms.h"
#include "tests/fixture.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const bb_option options[] = {BB_CODE_OPTIONS("mc32"), {.name = NULL}};

static void choose(const char *text, bb_spec *spec, bb_code_choice *choice)
{
    assert_int_equal(bb_spec_parse(text, spec), BB_OK);
    assert_int_equal(bb_spec_validate(spec, options, "builder test"), BB_OK);
    if (bb_code_choose(spec, options, choice) != BB_OK)
        fail_msg("%s: %s", text, bb_message());
}

/* ---- layouts ---- */

static bb_box box_of(double x, double y, double z)
{
    return (bb_box){.lo = {1, 2, 3}, .hi = {(float)(1 + x), (float)(2 + y), (float)(3 + z)}};
}

static void expect_letters(const char *text, bb_box box, const double direction[3],
                           const char *expected)
{
    bb_spec spec;
    bb_code_choice choice;
    bb_code_pattern layout;
    char letters[BB_CODE_BITS_MAX + 1];
    choose(text, &spec, &choice);
    bb_code_lay_out(&choice, (bb_box[]){box, box}, direction, &layout);
    bb_code_letters(&layout, letters, sizeof letters);
    assert_string_equal(letters, expected);
}

static void layouts_are_those_of_the_paper(void **state)
{
    (void)state;
    static const double none[3] = {0, 0, 0}, down[3] = {0.1, -3, 2};
    bb_box cube = box_of(4, 4, 4), tall = box_of(2, 8, 4), flat = box_of(64, 64, 1);
    expect_letters("c", cube, none, "xyzxyzxyzxyzxyzxyzxyzxyzxyzxyz");
    expect_letters("c", tall, none, "xyzxyzxyzxyzxyzxyzxyzxyzxyzxyz");
    expect_letters("c:bits=7", cube, none, "xyzxyzx");
    expect_letters("c:axes=extent,bits=9", tall, none, "yzxyzxyzx");
    expect_letters("c:count=variable,bits=12", tall, none, "yyzxyzxyzxyz");
    expect_letters("c:count=variable,bits=18", flat, none, "xyxyxyxyxyxyxyzxyz");
    expect_letters("c:code=emc32-sort", tall, none, "yzxsyzxsyzxsyzxsyzxsyzxsyzxsyzxs");
    expect_letters("c:code=emc32-var", cube, none, "xyzxyzsxyzxyzsxyzxyzsxyzxyzsxyzx");
    expect_letters("c:code=emc64-sort", cube, none,
                   "xyzsxyzsxyzsxyzsxyzsxyzsxyzsxyzsxyzsxyzsxyzsxyzsxyzsxyzsxyzsxyzs");
    expect_letters("c:code=emc64-var", cube, none,
                   "xyzxyzsxyzxyzsxyzxyzsxyzxyzsxyzxyzsxyzxyzsxyzxyzxyzxyzxyzxyzxyzx");
    expect_letters("c:code=emc64-var,size-bits=9,bits=63", cube, none,
                   "xyzxyzsxyzxyzsxyzxyzsxyzxyzsxyzxyzsxyzxyzsxyzxyzsxyzxyzsxyzxyzs");
    expect_letters("c:code=emc64-cell,bits=16", cube, none, "xyzsxyzsxyzsxyzs");
    expect_letters("c:code=emc64-cell,bits=23", flat, none, "xysxysxysxysxysxysxyzsx");
    expect_letters("c:view=0.1/-3/2,bits=6", cube, down, "YzxYzx");
    expect_letters("c:view=0.1/-3/2,axes=xyz,bits=6", cube, down, "xYzxYz");
    /* an axis without extent gets no bits of a variable code, and no axis more than a float tells
     * apart */
    expect_letters("c:count=variable,bits=64", box_of(1, 0, 0), none, "xxxxxxxxxxxxxxxxxxxxxxxx");
    expect_letters("c:count=variable,bits=8", box_of(0, 0, 0), none, "");
    expect_letters("c:bits=6", box_of(0, 0, 0), none, "xyzxyz");
}

static void wrong_options_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"c:bits=65", "option 'bits' is '65'"},
        {"c:bits=2", "option 'bits' is '2'"},
        {"c:every=1", "option 'every' is 1, must be 0 or 2 to 64"},
        {"c:size-bits=25", "option 'size-bits' is '25'"},
        {"c:axes=view", "axes=view needs a view="},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bb_spec spec;
        bb_code_choice choice;
        assert_int_equal(bb_spec_parse(cases[i].text, &spec), BB_OK);
        assert_int_equal(bb_code_choose(&spec, options, &choice), BB_INVALID);
        assert_non_null(strstr(bb_message(), cases[i].message));
    }
}

/* ---- keys ---- */

static double measure(const bb_code_choice *choice, double x, double y, double z)
{
    return choice->measure == BB_BY_AREA   ? sqrt(2 * (x * y + y * z + z * x))
           : choice->measure == BB_BY_SIDE ? fmax(x, fmax(y, z))
                                           : sqrt(x * x + y * y + z * z);
}

/* The size bit's answer for size = cell: the box is at least as large as the cell. */
static bool fills_cell(const bb_code_choice *choice, const double side[3], double unit,
                       float squared)
{
    double x = side[0] * unit, y = side[1] * unit, z = side[2] * unit;
    double root = choice->large * measure(choice, x, y, z);
    return squared >= (float)(root * root);
}

/* In the order of the definition, one bit after the other; floats are rounded where the device
 * rounds. */
static uint64_t reference_key(const bb_code_choice *choice, const bb_code_pattern *layout,
                              const bb_box *bounds, const bb_box *box, uint32_t flips)
{
    const bb_box *whole = &bounds[choice->by_centroids ? 1 : 0];
    double side[3], all = 0;
    uint64_t cells[4] = {0};
    float e[3];
    for (int k = 0; k < 3; k++) {
        side[k] = (double)whole->hi[k] - whole->lo[k];
        all = fmax(all, side[k]);
    }
    double unit = all > 0 && 1 / all <= FLT_MAX ? 1 / all : 0;
    for (int k = 0; k < 3; k++) {
        double cells_per_unit = ldexp(1, (int)layout->count[k]) / side[k];
        float scale = side[k] > 0 && layout->count[k] > 0 && cells_per_unit <= FLT_MAX
                          ? (float)cells_per_unit
                          : 0;
        float at = ((0.5f * box->lo[k] + 0.5f * box->hi[k]) - whole->lo[k]) * scale;
        float last = (float)((1u << layout->count[k]) - 1);
        cells[k] = (uint64_t)(at < last ? at : last);
        e[k] = (0.5f * box->hi[k] - 0.5f * box->lo[k]) * (2.0f * (float)unit);
    }
    float side_max = fmaxf(e[0], fmaxf(e[1], e[2]));
    float squared = choice->measure == BB_BY_AREA
                        ? 2.0f * ((e[0] * e[1] + e[1] * e[2]) + e[2] * e[0])
                    : choice->measure == BB_BY_SIDE ? side_max * side_max
                                                    : (e[0] * e[0] + e[1] * e[1]) + e[2] * e[2];
    uint32_t size_bits = layout->count[3];
    if (size_bits > 0 && choice->sizes != BB_SIZES_CELL && unit > 0) {
        bool root = choice->sizes == BB_SIZES_ROOT;
        double x = side[0] * unit, y = side[1] * unit, z = side[2] * unit;
        double scene = measure(choice, x, y, z);
        double cells_per_unit = ldexp(1, (int)(root ? 2 * size_bits : size_bits)) / scene;
        float scale = scene > 0 && cells_per_unit <= FLT_MAX ? (float)cells_per_unit : 0;
        float size = sqrtf(squared) * scale;
        size = root ? sqrtf(floorf(size)) : size;
        float last = (float)((1u << size_bits) - 1);
        cells[3] = (uint64_t)(size < last ? size : last);
    }
    uint64_t key = 0;
    uint32_t left[4];
    double cell[3] = {side[0], side[1], side[2]};
    memcpy(left, layout->count, sizeof left);
    for (uint32_t i = 0; i < layout->bits; i++) {
        uint32_t axis = layout->axes[i];
        uint64_t bit;
        if (axis == BB_CODE_SIZE_AXIS && choice->sizes == BB_SIZES_CELL)
            bit = unit > 0 && fills_cell(choice, cell, unit, squared);
        else
            bit = cells[axis] >> --left[axis] & 1;
        if (axis != BB_CODE_SIZE_AXIS) {
            cell[axis] *= 0.5;
            bit ^= flips >> axis & 1;
        }
        key = key << 1 | bit;
    }
    return key;
}

static void reduce(const bb_box *boxes, uint32_t count, bb_box bounds[2])
{
    bounds[0] = bounds[1] =
        (bb_box){.lo = {INFINITY, INFINITY, INFINITY}, .hi = {-INFINITY, -INFINITY, -INFINITY}};
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            float c = 0.5f * boxes[i].lo[k] + 0.5f * boxes[i].hi[k];
            bounds[0].lo[k] = fminf(bounds[0].lo[k], boxes[i].lo[k]) + 0.0f;
            bounds[0].hi[k] = fmaxf(bounds[0].hi[k], boxes[i].hi[k]) + 0.0f;
            bounds[1].lo[k] = fminf(bounds[1].lo[k], c) + 0.0f;
            bounds[1].hi[k] = fmaxf(bounds[1].hi[k], c) + 0.0f;
        }
}

/* `leave_bounds`: of a builder that asks for none; its reference lays the code out itself. */
static void compare_keys(bb_device *device, const char *text, const bb_box *boxes, uint32_t count,
                         bool leave_bounds, const char *what)
{
    bb_scene scene = {.name = "test", .prim_count = count, .boxes = (bb_box *)boxes};
    bb_account account = {0};
    bb_spec spec;
    bb_code_choice choice;
    bb_builder_context context = {
        .device = device, .account = &account, .spec = &spec, .options = options};
    bb_primitives *primitives = NULL;
    bb_codes *codes = NULL;
    bb_buffer d_keys = {0}, d_values = {0};
    bb_phases phases = {.device = device, .current = -1};
    bb_box bounds[2];
    bb_code_pattern layout;
    double direction[3];
    choose(text, &spec, &choice);
    uint32_t bytes = choice.bits > 32 ? 8 : 4;
    uint64_t *keys = calloc(count, sizeof *keys);
    uint32_t *values = calloc(count, sizeof *values);
    assert_int_equal(bb_primitives_create(device, &account, &primitives), BB_OK);
    if (bb_codes_create(&context, leave_bounds, &codes) != BB_OK)
        fail_msg("%s: %s", text, bb_message());
    assert_int_equal(
        bb_buffer_reserve(device, NULL, count * sizeof *boxes, "boxes", &scene.on_device.boxes),
        BB_OK);
    assert_int_equal(bb_buffer_write(&scene.on_device.boxes, 0, count * sizeof *boxes, boxes),
                     BB_OK);
    assert_int_equal(bb_buffer_reserve(device, NULL, count * bytes, "keys", &d_keys), BB_OK);
    assert_int_equal(bb_buffer_reserve(device, NULL, count * 4ul, "values", &d_values), BB_OK);
    for (int time = 0; time < 2; time++) {
        const uint64_t waits = device->waits;
        if (bb_codes_make(codes, primitives, &scene, &d_keys, &d_values, &phases) != BB_OK)
            fail_msg("%s: %s", text, bb_message());
        if (time > 0 && leave_bounds && bb_code_is_fixed(&choice) && !choice.tables)
            assert_int_equal(device->waits, waits);
    }
    assert_int_equal(bb_buffer_read(&d_keys, 0, count * bytes, keys), BB_OK);
    assert_int_equal(bb_buffer_read(&d_values, 0, count * 4ul, values), BB_OK);
    assert_int_equal(bb_view_order(&scene, choice.view, "test", direction), BB_OK);
    reduce(boxes, count, bounds);
    bb_code_lay_out(&choice, bounds, direction, &layout);
    uint32_t flips = bb_axis_order_of(direction).flips;
    for (uint32_t i = 0; i < count; i++) {
        uint64_t key = bytes == 8 ? keys[i] : ((uint32_t *)keys)[i];
        uint64_t expected = reference_key(&choice, &layout, bounds, &boxes[i], flips);
        if (key != expected || values[i] != i)
            fail_msg("%s, %s, seed %llu, box %u of %u: key %llx, not %llx", text, what,
                     (unsigned long long)seed, i, count, (unsigned long long)key,
                     (unsigned long long)expected);
    }
    bb_buffer_release(&scene.on_device.boxes);
    bb_buffer_release(&d_keys);
    bb_buffer_release(&d_values);
    bb_codes_destroy(codes);
    bb_primitives_destroy(primitives);
    free(keys);
    free(values);
}

static void compare(bb_device *device, const char *text, const bb_box *boxes, uint32_t count,
                    const char *what)
{
    compare_keys(device, text, boxes, count, false, what);
    compare_keys(device, text, boxes, count, true, what);
}

/* Boxes of all kinds of extremes: points, flat, as large as the scene, denormal, huge, all in one
 * place. */
static void fill(bb_random *random, uint32_t kind, uint32_t count, bb_box *boxes)
{
    for (uint32_t i = 0; i < count; i++) {
        boxes[i] = (bb_box){0};
        for (int k = 0; k < 3; k++) {
            double scale = kind == 1 ? (k == 1 ? 1e-3 : 1) : 1;
            double c = bb_random_range(random, -scale, scale), e = bb_random_unit(random);
            e = scale * ldexp(e, -(int)bb_random_below(random, 20));
            if (kind == 2)
                c = 7, e = k == 0 ? 0 : e;
            if (kind == 3)
                c = ldexp(c, (int)bb_random_below(random, 200) - 140), e = fabs(c) * e;
            if (kind == 4)
                c *= 3e38, e *= 1e37;
            if (kind == 5)
                c = k == 2 ? c : 0, e = 0;
            if (kind == 6)
                c = (i == 0 ? 1e8 : 1) * c;
            boxes[i].lo[k] = (float)(c - e);
            boxes[i].hi[k] = (float)(c + e);
        }
    }
}

static void keys_are_those_of_the_definition(void **state)
{
    (void)state;
    static const char *const kinds[] = {"uniform", "flat", "one place", "exponents",
                                        "huge",    "line", "outlier"};
    static const char *const texts[] = {
        "c",
        "c:code=mc64,box=scene",
        "c:code=mc64,expand=tables",
        "c:code=emc32-sort",
        "c:code=emc32-var,box=scene",
        "c:code=emc32-var,expand=tables",
        "c:code=emc64-sort",
        "c:code=emc64-sort,size=root,measure=area",
        "c:code=emc64-var",
        "c:code=emc64-var,expand=tables,box=scene",
        "c:code=emc64-var,size=cell",
        "c:code=emc64-var,size=cell,large=0.4,measure=side",
        "c:code=emc64-var,size=cell,measure=area,every=4,size-bits=16",
        "c:code=emc64-cell",
        "c:code=emc64-var,view=-1/2/-3",
        "c:code=emc32-sort,size=cell,view=1/-2/0",
        "c:bits=33,every=2,size-bits=24",
        "c:bits=3",
    };
    static const uint32_t counts[] = {1, 7, 8, 1003};
    bool small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    for (uint32_t kind = 0; kind < sizeof kinds / sizeof kinds[0]; kind++)
        for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
            if (small && (c == 1 || counts[c] > 100))
                continue;
            bb_random random = bb_random_make(seed, 10 * kind + c);
            bb_box *boxes = malloc(counts[c] * sizeof *boxes);
            fill(&random, kind, counts[c], boxes);
            for (size_t t = 0; t < sizeof texts / sizeof texts[0]; t++)
                for (int form = CPU_FORM; form <= GPU_FORM; form++)
                    compare(devices[form], texts[t], boxes, counts[c], kinds[kind]);
            free(boxes);
        }
}

int main(void)
{
    seed = seed_or(20261121);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(layouts_are_those_of_the_paper),
        cmocka_unit_test(wrong_options_are_refused),
        cmocka_unit_test(keys_are_those_of_the_definition),
    };
    return cmocka_run_group_tests(tests, open_devices, close_devices);
}
