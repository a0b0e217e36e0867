/* Structs that builders share with their device code: the device lays them out as the host does.
 * (Those of kernels/bb_shared.h: test_device.c.) */
#include "builders/aac/aac_shared.h"
#include "builders/bonsai/bonsai_shared.h"
#include "builders/common/code_shared.h"
#include "builders/common/pair_shared.h"
#include "builders/hlbvh/hlbvh_shared.h"
#include "builders/hploc/hploc_shared.h"
#include "builders/presplit/presplit_shared.h"
#include "builders/refit/parts_shared.h"
#include "builders/refit/turns_shared.h"
#include "builders/reinsert/reinsert_shared.h"
#include "kernels/cell_grid_shared.h"
#include "kernels/tet_shared.h"
#include "kernels/volume_shared.h"
#include "kernels/wide_direct_shared.h"
#include "tests/device_fixture.h"

#include <stdio.h>

BB_DEVICE_SOURCE(aac);
BB_DEVICE_SOURCE(bonsai_top);
BB_DEVICE_SOURCE(hlbvh);
BB_DEVICE_SOURCE(hploc);
BB_DEVICE_SOURCE(parts);
BB_DEVICE_SOURCE(presplit);
BB_DEVICE_SOURCE(reinsert_moves);

typedef struct shared_struct {
    const char *header;
    const bb_source *beside; /* a source of the header's folder; NULL: any folder will do */
    const char *name;
    size_t bytes;
} shared_struct;

#define ROW(header, beside, name)                                                                  \
    {                                                                                              \
        header, beside, #name, sizeof(name)                                                        \
    }
#define AAC(name) ROW("aac_shared.h", &bb_source_aac, name)
#define BONSAI(name) ROW("bonsai_shared.h", &bb_source_bonsai_top, name)
#define HLBVH(name) ROW("hlbvh_shared.h", &bb_source_hlbvh, name)
#define HPLOC(name) ROW("hploc_shared.h", &bb_source_hploc, name)
#define PAIR(name) ROW("pair_shared.h", NULL, name)
#define PRESPLIT(name) ROW("presplit_shared.h", &bb_source_presplit, name)
#define REINSERT(name) ROW("reinsert_shared.h", &bb_source_reinsert_moves, name)
#define TETS(name) ROW("tet_shared.h", NULL, name)
#define VOLUMES(name) ROW("volume_shared.h", NULL, name)
#define DIRECT(name) ROW("wide_direct_shared.h", NULL, name)

static const shared_struct structs[] = {
    AAC(aac_cluster),
    AAC(aac_range),
    BONSAI(bn_mini_span),
    BONSAI(bn_top_span),
    BONSAI(bn_split),
    BONSAI(bn_item),
    BONSAI(bn_task),
    ROW("code_shared.h", NULL, bb_code_plan),
    HLBVH(hl_item),
    HLBVH(hl_root),
    HLBVH(hl_task),
    HLBVH(hl_split),
    HLBVH(hl_chunk),
    HPLOC(hploc_piece),
    PAIR(bb_pair_side),
    PAIR(bb_cluster_pair),
    PAIR(bb_pair_task),
    ROW("parts_shared.h", &bb_source_parts, bb_part),
    PRESPLIT(ps_grid),
    PRESPLIT(ps_tries),
    REINSERT(bb_family),
    REINSERT(bb_move),
    ROW("turns_shared.h", &bb_source_parts, bb_turn_totals),
    ROW("cell_grid_shared.h", NULL, bb_cell_grid),
    TETS(bb_located),
    TETS(bb_locate_args),
    TETS(bb_slice_args),
    TETS(bb_sliced),
    TETS(bb_tet_march_args),
    VOLUMES(bb_volume_grid),
    VOLUMES(bb_transfer_entry),
    VOLUMES(bb_march_args),
    VOLUMES(bb_light),
    DIRECT(bb_direct_piece),
    DIRECT(bb_direct_done),
    DIRECT(bb_direct_state),
};

enum { COUNT = sizeof structs / sizeof *structs };

/* sizeof(s->name), by the device's compiler. */
static uint32_t size_on_device(const shared_struct *s)
{
    char text[512];
    uint32_t found = 0;
    cl_program program = NULL;
    cl_kernel kernel = NULL;
    bb_buffer out;
    snprintf(text, sizeof text,
             "#include \"bb_device.h\"\n#include \"%s\"\n"
             "kernel void size_of(global uint *out) { out[0] = sizeof(%s); }\n",
             s->header, s->name);
    const bb_source source = {
        .name = "size_of.cl", .text = text, .folder = s->beside != NULL ? s->beside->folder : NULL};
    make_buffer(&out, NULL, sizeof found);
    check(bb_program_build(device, &source, "", &program), s->name);
    check(bb_kernel_get(program, "size_of", &kernel), s->name);
    check(bb_launch(device, kernel, 1, 1, BB_MEM(out)), s->name);
    check(bb_buffer_read(&out, 0, sizeof found, &found), s->name);
    bb_buffer_release(&out);
    bb_kernel_release(kernel);
    bb_program_release(program);
    bb_programs_clear(device); /* the next has the same name */
    return found;
}

static void structs_have_one_size_everywhere(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < COUNT; i++) {
        uint32_t found = size_on_device(&structs[i]);
        if (found != structs[i].bytes)
            fail_msg("%s has %zu bytes on the host, %u on the device", structs[i].name,
                     structs[i].bytes, found);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(structs_have_one_size_everywhere)};
    return cmocka_run_group_tests(tests, open_device, close_device);
}
