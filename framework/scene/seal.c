/* Whether somebody wrote into a scene: hashes of all that builders get pointers to. */
#include "framework/scene/seal.h"

#include "framework/device/cl_error.h"
#include "framework/device/device_private.h"
#include "framework/scene/prim.h"
#include "framework/scene/scene_private.h"
#include "framework/scene/tets.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

enum {
    LINE = 64,    /* bytes */
    ITEMS = 4096, /* that hash a buffer together */
    GROUP_SIZE = 64,
    PARTS_MAX = 10 + 6 + BB_KIND_COUNT,
};

/* Of a part that is larger, such as the bricks of a volume, evenly spaced lines are hashed. */
static const uint64_t bytes_hashed = (uint64_t)256 << 20;

/* Memory of the host, or a buffer. */
typedef struct part {
    const char *what;
    const void *memory;
    const bb_buffer *buffer;
    uint64_t bytes;
} part;

typedef struct parts {
    part items[PARTS_MAX];
    uint32_t count;
} parts;

static void add(parts *all, const char *what, const void *memory, uint64_t bytes)
{
    if (memory != NULL && bytes > 0)
        all->items[all->count++] = (part){.what = what, .memory = memory, .bytes = bytes};
}

static void add_buffer(parts *all, const char *what, const bb_buffer *buffer, uint64_t bytes)
{
    if (buffer->mem != NULL && bytes > 0)
        all->items[all->count++] = (part){.what = what, .buffer = buffer, .bytes = bytes};
}

static void list_host(const bb_scene *scene, parts *all)
{
    const bb_volume *volume = scene->volume;
    const bb_tets *tets = scene->tets;
    add(all, "boxes", scene->boxes, scene->prim_count * sizeof *scene->boxes);
    add(all, "vertices", scene->vertices, scene->vertex_count * 3 * sizeof *scene->vertices);
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        add(all, "primitives", scene->prims[kind].data,
            scene->prims[kind].count * bb_prim_bytes(kind));
    if (scene->object_count > 0)
        add(all, "objects", scene->object_starts,
            ((size_t)scene->object_count + 1) * sizeof *scene->object_starts);
    add(all, "objects that move", scene->movers, scene->mover_count * sizeof *scene->movers);
    if (volume != NULL) {
        add(all, "volume", volume, sizeof *volume);
        add(all, "bricks", volume->bricks, bb_volume_bytes(volume));
        add(all, "ranges of bricks", volume->ranges, volume->brick_count * sizeof *volume->ranges);
    }
    if (tets != NULL) {
        add(all, "tetrahedra", tets, sizeof *tets);
        add(all, "flags of tetrahedra", tets->flags,
            scene->prims[BB_TETRAHEDRON].count * sizeof *tets->flags);
        add(all, "scalar field", tets->field, scene->vertex_count * sizeof *tets->field);
    }
}

static void list_device(const bb_scene *scene, parts *all)
{
    const bb_scene_device *there = &scene->on_device;
    const bb_volume *volume = scene->volume;
    uint64_t prim_bytes = 0;
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        prim_bytes += scene->prims[kind].count * bb_prim_bytes(kind);
    add_buffer(all, "boxes on the device", &there->boxes, scene->prim_count * sizeof(bb_box));
    add_buffer(all, "vertices on the device", &there->vertices,
               scene->vertex_count * 3 * sizeof(float));
    add_buffer(all, "primitives on the device", &there->prims, prim_bytes);
    if (volume != NULL) {
        add_buffer(all, "bricks on the device", &there->bricks, bb_volume_bytes(volume));
        add_buffer(all, "ranges of bricks on the device", &there->ranges,
                   volume->brick_count * sizeof *volume->ranges);
        add_buffer(all, "visibility on the device", &there->seen, sizeof volume->seen);
    }
    if (scene->tets != NULL) {
        add_buffer(all, "flags of tetrahedra on the device", &there->tet_flags,
                   scene->prims[BB_TETRAHEDRON].count * sizeof(uint32_t));
        add_buffer(all, "scalar field on the device", &there->field,
                   scene->vertex_count * sizeof(float));
    }
}

static uint32_t stride_of(uint64_t bytes)
{
    return (uint32_t)((bytes + bytes_hashed - 1) / bytes_hashed);
}

static uint64_t hash_memory(const part *p)
{
    const char *at = p->memory;
    if (p->bytes <= bytes_hashed)
        return XXH3_64bits(at, p->bytes);
    uint64_t hash = 0;
    const uint64_t step = (uint64_t)stride_of(p->bytes) * LINE;
    for (uint64_t i = 0; i + LINE <= p->bytes; i += step)
        hash = XXH3_64bits_withSeed(at + i, LINE, hash);
    return hash;
}

/* The kernel that hashes, and room for its hashes. */
typedef struct hasher {
    cl_program program;
    cl_kernel kernel;
    bb_buffer hashes;
    uint32_t *words; /* [ITEMS] on the host */
} hasher;

static bb_status open_hasher(bb_device *device, hasher *h)
{
    BB_TRY(bb_program_build(device, bb_source_find("seal.cl"), "", &h->program));
    BB_TRY(bb_kernel_get(h->program, "seal_lines", &h->kernel));
    /* neither is of the memory that scenes and trees share: they may have filled it */
    const size_t bytes = ITEMS * sizeof *h->words;
    cl_int error;
    h->hashes = (bb_buffer){.bytes = bytes, .device = device};
    h->hashes.mem = clCreateBuffer(device->context, CL_MEM_READ_WRITE, bytes, NULL, &error);
    BB_CL_TRY(error, "room for hashes of the scene");
    h->words = malloc(ITEMS * sizeof *h->words);
    return h->words != NULL ? BB_OK : bb_fail(BB_REFUSED, "no memory for hashes of the scene");
}

static void close_hasher(hasher *h)
{
    free(h->words);
    if (h->hashes.mem != NULL)
        clReleaseMemObject(h->hashes.mem);
    bb_kernel_release(h->kernel);
    bb_program_release(h->program);
}

static bb_status hash_buffer(bb_device *device, hasher *h, const part *p, uint64_t *hash)
{
    const uint32_t lines = (uint32_t)(p->bytes / LINE), stride = stride_of(p->bytes);
    const uint32_t tail = (uint32_t)(p->bytes % LINE / sizeof(uint32_t));
    uint32_t items = lines / stride < ITEMS ? lines / stride / GROUP_SIZE * GROUP_SIZE : ITEMS;
    items = items > GROUP_SIZE ? items : GROUP_SIZE;
    BB_TRY(bb_launch(device, h->kernel, items, GROUP_SIZE, BB_MEM(*p->buffer), BB_VALUE(lines),
                     BB_VALUE(stride), BB_VALUE(tail), BB_MEM(h->hashes)));
    BB_TRY(bb_buffer_read(&h->hashes, 0, items * sizeof *h->words, h->words));
    *hash = XXH3_64bits(h->words, items * sizeof *h->words);
    return BB_OK;
}

/* Hashes all parts: hashes[i] of parts[i]. */
static bb_status hash_all(const bb_scene *scene, const parts *all, uint64_t *hashes)
{
    hasher h = {0};
    const bool buffers = all->count > 0 && all->items[all->count - 1].buffer != NULL;
    bb_device *device = buffers ? scene->on_device.device : NULL;
    bb_status status = device != NULL ? open_hasher(device, &h) : BB_OK;
    for (uint32_t i = 0; i < all->count && status == BB_OK; i++)
        if (all->items[i].buffer != NULL)
            status = hash_buffer(device, &h, &all->items[i], &hashes[i]);
        else
            hashes[i] = hash_memory(&all->items[i]);
    close_hasher(&h);
    return status;
}

/* Lists the host's parts before the device's. */
static void list(const bb_scene *scene, parts *all)
{
    all->count = 0;
    list_host(scene, all);
    list_device(scene, all);
}

struct bb_scene_seal {
    uint64_t hashes[PARTS_MAX];
    bool lost; /* it was written into, and could not be put back */
};

bb_status bb_scene_seal(bb_scene *scene)
{
    parts all;
    list(scene, &all);
    if (scene->seal == NULL) {
        BB_TRY(bb_host_alloc(NULL, sizeof *scene->seal, "hashes of the scene", &scene->seal));
        scene->seal->lost = false;
    }
    return hash_all(scene, &all, scene->seal->hashes);
}

/* ---- what was changed, and putting it back ---- */

/* Returns the index of the first part that is not what it was, on the host before the device;
 * BB_NONE: there is none. */
static bb_status find_changed(const bb_scene *scene, const parts *all, uint32_t *which)
{
    uint64_t hashes[PARTS_MAX] = {0};
    BB_TRY(hash_all(scene, all, hashes));
    for (*which = 0; *which < all->count; ++*which)
        if (hashes[*which] != scene->seal->hashes[*which])
            return BB_OK;
    *which = BB_NONE;
    return BB_OK;
}

/* Puts the host's memory back, from the scene's file or generator. */
static bb_status load_host_again(const bb_scene *scene, const parts *all)
{
    bb_scene *again = NULL;
    parts from;
    BB_TRY(bb_scene_load_any(scene->name, &again));
    bb_status status = BB_OK;
    if (scene->frame != 0)
        status = bb_scene_set_frame(again, scene->frame, NULL);
    list(again, &from);
    if (again->hash != scene->hash || again->prim_count != scene->prim_count)
        status = bb_fail(BB_FAILED, "%s: has changed since it was loaded", scene->name);
    for (uint32_t i = 0; i < from.count && status == BB_OK; i++) {
        /* the structs of a volume and of tetrahedra hold pointers, which stay */
        const bool is_struct =
            all->items[i].memory == scene->volume || all->items[i].memory == scene->tets;
        if (!is_struct)
            memcpy((void *)(uintptr_t)all->items[i].memory, from.items[i].memory,
                   all->items[i].bytes);
    }
    bb_scene_free(again);
    return status;
}

/* Puts everything back. */
static bb_status mend(const bb_scene *scene, const parts *all, bool on_host)
{
    uint32_t left;
    if (on_host)
        BB_TRY(load_host_again(scene, all));
    bb_scene there = *scene; /* its buffers stay where they are */
    if (there.on_device.device != NULL)
        BB_TRY(bb_scene_fill(&there));
    BB_TRY(find_changed(scene, all, &left));
    return left == BB_NONE ? BB_OK
                           : bb_fail(BB_FAILED, "%s: its %s cannot be put back", scene->name,
                                     all->items[left].what);
}

static bb_status check_seal(const bb_scene *scene, bool on_host, const char **changed)
{
    parts all, some = {.count = 0};
    uint32_t which;
    *changed = NULL;
    if (scene->seal == NULL)
        return BB_OK;
    if (scene->seal->lost)
        return bb_fail(BB_FAILED, "%s: a builder wrote into it, and it cannot be put back",
                       scene->name);
    list(scene, &all);
    if (on_host)
        list_host(scene, &some);
    BB_TRY(find_changed(scene, on_host ? &some : &all, &which));
    if (which == BB_NONE)
        return BB_OK;
    *changed = all.items[which].what;
    const bb_status status = mend(scene, &all, all.items[which].buffer == NULL);
    scene->seal->lost = status != BB_OK;
    return status;
}

bb_status bb_scene_check_seal(const bb_scene *scene, const char **changed)
{
    return check_seal(scene, false, changed);
}

bb_status bb_scene_check_seal_on_host(const bb_scene *scene, const char **changed)
{
    return check_seal(scene, true, changed);
}

void bb_scene_put_back(const bb_scene *scene)
{
    char message[BB_MESSAGE_MAX];
    const char *unused;
    snprintf(message, sizeof message, "%s", bb_message());
    (void)bb_scene_check_seal(scene, &unused);
    (void)bb_fail(BB_FAILED, "%s", message);
}

void bb_scene_is_whole(bb_scene *scene)
{
    if (scene->seal != NULL)
        scene->seal->lost = false;
}
