/* Compiles kernels for what a scene needs, and launches them. */
#include "traversal/ray_order.h"
#include "traversal/stack_room.h"

#include "framework/scene/prim.h"

#include <assert.h>
#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct bb_traverser {
    bb_traverser *next;
    bb_device *device;
    char key[1024]; /* source and defines */
    uint32_t group;
    uint32_t stack_size, stacks; /* entries; stacks per work-item */
    uint64_t launched;
    bool counting, recording;
    bool persistent;
    bool batched;
    bool sorted;     /* rays are taken in an order of their own */
    bb_buffer taken; /* u32: rays that groups have taken; persistent form only */
    bb_u32 format;   /* of the triangles that it reads */
    uint32_t lanes;  /* primitives side by side */
    cl_program program;
    cl_kernel kernel;
};

static bb_traverser *cache;

/* Groups of the persistent form per compute unit: enough to hide latency on current GPUs; further
 * groups would find no rays left. */
enum { GROUPS_PER_UNIT = 16 };

/* A deeper tree overflows: its rays are left poisoned, counted and reported. A stack is private
 * memory of each work-item. */
enum { STACK_MAX = 1024 };

/* On CPUs a stack that is not used costs nothing, and each size would be compiled again. */
enum { STACK_LEAST_ON_CPUS = 128 };

static uint32_t least_stack(const bb_device *device)
{
    return device->is_cpu ? STACK_LEAST_ON_CPUS : BB_STACK_LEAST;
}

static uint32_t round_stack(const bb_device *device, uint32_t need)
{
    uint32_t size = least_stack(device);
    while (size < need && size < STACK_MAX)
        size *= 2;
    return size;
}

static uint32_t round_levels(uint32_t levels)
{
    uint32_t size = 64; /* a word of the trail */
    while (size < levels)
        size *= 2;
    return size;
}

/* The layout's needs, unless a parameter says otherwise. */
typedef struct variant {
    uint32_t stack_size; /* 0: no stack of the tree's size */
    uint32_t kinds, levels;
    bool stack_given, stack_capped, kinds_given;
} variant;

static bb_status choose_variant(const bb_device *device, const bb_traverser_request *request,
                                const bb_layout_data *layout, variant *v)
{
    const bb_kernel *kernel = request->kernel;
    const bb_spec *spec = request->spec;
    *v = (variant){.kinds = layout->kinds};
    const char *stack = bb_spec_value(spec, NULL, "stack");
    v->stack_given = stack != NULL && strcmp(stack, "auto") != 0;
    v->kinds_given = bb_kernel_wish(spec).kinds != 0;
    if (kernel->trail_max > 0)
        v->levels = round_levels(layout->levels);
    if (kernel->stackless)
        return BB_OK;
    v->stack_size = round_stack(device, layout->stack_need);
    const uint32_t stacks = bb_stacks_of_item(kernel, spec), room = bb_stack_room(device, stacks);
    uint64_t given;
    if (v->stack_given) {
        BB_TRY(bb_spec_u64(spec, bb_kernel_common_options, "stack", 1, STACK_MAX, &given));
        v->stack_size = (uint32_t)given;
        if (given > room)
            return bb_fail(BB_REFUSED,
                           "kernel %s: the device has no room for %u stacks of %u entries in each "
                           "work-item: at most stack=%u, or take the kernel short",
                           kernel->name, stacks, (uint32_t)given, room);
    }
    v->stack_capped = v->stack_size > room;
    if (v->stack_capped)
        v->stack_size = room;
    return BB_OK;
}

bb_status bb_traverser_decide(const bb_device *device, const bb_traverser_request *request,
                              const bb_layout_data *layout, bb_decisions *decisions)
{
    variant v;
    char compiled[64], there[64];
    BB_TRY(choose_variant(device, request, layout, &v));
    bb_prim_kind_names(v.kinds, compiled, sizeof compiled);
    there[0] = '\0';
    for (uint32_t kind = 0, last = 0; kind < BB_KIND_COUNT; kind++) {
        size_t used = strlen(there);
        snprintf(there + used, sizeof there - used, "%s%u %s", used > 0 ? ", " : "",
                 layout->ends.end[kind] - last, bb_prim_kinds[kind]->plural);
        last = layout->ends.end[kind];
    }
    decisions->count = 0;
    if (v.stack_capped)
        bb_decide_number(decisions, BB_DECIDED_STACK, v.stack_size, BB_BY_DEVICE,
                         "the tree needs %u, the device's memory has room for %u",
                         layout->stack_need, v.stack_size);
    else if (v.stack_size > 0)
        bb_decide_number(decisions, BB_DECIDED_STACK, v.stack_size,
                         v.stack_given                         ? BB_GIVEN
                         : v.stack_size == least_stack(device) ? BB_BY_DEFAULT
                                                               : BB_BY_TREE,
                         "the tree needs %u", layout->stack_need);
    if (v.levels > 0)
        bb_decide_number(decisions, "levels of the trail", v.levels, BB_BY_TREE,
                         "the tree has %u at most", layout->levels);
    bb_decide_word(decisions, BB_DECIDED_KINDS, compiled, v.kinds_given ? BB_GIVEN : BB_BY_SCENE,
                   "the scene has %s", there);
    return BB_OK;
}

static void release(bb_traverser *traverser)
{
    bb_buffer_release(&traverser->taken);
    bb_kernel_release(traverser->kernel);
    bb_program_release(traverser->program);
    free(traverser);
}

/* ---- the compiler's options ---- */

/* The definitions are the key of a cached program: truncated ones could belong to another
 * variant. */
__attribute__((format(printf, 3, 4))) static bb_status append(char *text, size_t capacity,
                                                              const char *format, ...)
{
    size_t length = strlen(text);
    va_list list;
    va_start(list, format);
    int more = vsnprintf(text + length, capacity - length, format, list);
    va_end(list);
    return more >= 0 && (size_t)more < capacity - length
               ? BB_OK
               : bb_fail(BB_FAILED, "the definitions of a kernel have no room in %zu characters",
                         capacity - 1);
}

/* Appends the kernel's own options as -DBB_NAME=value, with '-' replaced by '_'. */
static bb_status append_options(const bb_kernel *kernel, const bb_spec *spec, char *text,
                                size_t capacity)
{
    for (const bb_option *o = kernel->options; o != NULL && o->name != NULL; o++) {
        size_t length = strlen(text);
        BB_TRY(append(text, capacity, " -DBB_%s=%s", o->name,
                      bb_spec_value(spec, kernel->options, o->name)));
        for (char *c = text + length + 3; *c != '\0' && *c != '='; c++)
            *c = *c == '-' ? '_' : (char)toupper((unsigned char)*c);
    }
    return BB_OK;
}

static const char *or_empty(const char *text)
{
    return text != NULL ? text : "";
}

static bool is_persistent(const bb_traverser_request *request)
{
    return bb_spec_is(request->spec, bb_kernel_common_options, "persistent", "yes");
}

static bool is_sorted(const bb_traverser_request *request)
{
    return bb_spec_is(request->spec, bb_kernel_common_options, "sort", "yes");
}

static bb_status write_defines(const bb_device *device, const bb_traverser_request *request,
                               const bb_layout_data *layout, const variant *v, uint32_t group,
                               char *text, size_t capacity)
{
    const bb_kernel *kernel = request->kernel;
    bb_intersector_defines(request->intersector, text, capacity);
    /* so that the same steps give all kernels the same bits */
    if (bb_intersector_is_exact(request->intersector) && bb_device_divides_exactly(device))
        BB_TRY(append(text, capacity, " -cl-fp32-correctly-rounded-divide-sqrt"));
    BB_TRY(append(text, capacity,
                  " %s -DBB_KINDS=%u -D%s %s -DBB_COUNTING=%d -DBB_PERSISTENT=%d -DBB_LANES=%u",
                  or_empty(kernel->defines), v->kinds, request->query->define,
                  or_empty(request->defines), request->counting || request->recording,
                  is_persistent(request), layout->lanes));
    if (request->recording)
        BB_TRY(append(text, capacity, " -DBB_RECORDING=1"));
    if (!bb_cpu_form(device))
        BB_TRY(append(text, capacity, " -DBB_GPU_FORM=1"));
    if (v->stack_size > 0)
        BB_TRY(append(text, capacity, " -DBB_STACK_SIZE=%u", v->stack_size));
    if (v->levels > 0)
        BB_TRY(append(text, capacity, " -DBB_LEVELS=%u", v->levels));
    if (kernel->batched)
        BB_TRY(append(text, capacity, " -DBB_BATCH=%u", group));
    if (is_sorted(request))
        BB_TRY(append(text, capacity, " -DBB_SORTED=1"));
    return append_options(kernel, request->spec, text, capacity);
}

/* ---- traversers ---- */

/* Checks that the kernel answers the query for these primitives, and that its trail suffices. */
static bb_status check_request(const bb_traverser_request *request, const bb_layout_data *layout)
{
    const bb_kernel *kernel = request->kernel;
    const bb_query *query = request->query;
    if ((kernel->queries & query->way) == 0)
        return bb_fail(BB_UNSUPPORTED, "kernel %s does not answer %s queries", kernel->name,
                       query->name);
    if ((layout->kinds & ~query->kinds) != 0) {
        char kinds[64];
        bb_prim_kind_names(query->kinds, kinds, sizeof kinds);
        return bb_fail(BB_UNSUPPORTED, "%s queries are for %s alone", query->name, kinds);
    }
    const bool alone = kernel->control == BB_PACKETS && (layout->kinds & BB_TRIANGLES) == 0;
    if (request->recording && alone)
        return bb_fail(BB_UNSUPPORTED,
                       "steps of packets are recorded on triangles alone, not by kernel %s here",
                       kernel->name);
    if (request->recording && (!bb_kernel_records(kernel, query) || is_sorted(request)))
        return bb_fail(BB_UNSUPPORTED, "steps of kernel %s%s are not recorded for %s queries",
                       kernel->name, is_sorted(request) ? ":sort=yes" : "", query->name);
    if (kernel->trail_max > 0 && layout->levels > kernel->trail_max)
        return bb_fail(
            BB_UNSUPPORTED,
            "the trail of kernel %s is at most %u levels long and the tree has up to %u; a kernel "
            "without a trail may take it",
            kernel->name, kernel->trail_max, layout->levels);
    return BB_OK;
}

/* Makes what depends on the device: the program, its kernel, the counter of the persistent form. */
static bb_status compile(bb_traverser *traverser, const bb_kernel *kernel, const char *defines)
{
    const bb_source *source = bb_source_find(kernel->source);
    if (source == NULL)
        return bb_fail(BB_FAILED, "kernel %s: there is no kernels/%s", kernel->name,
                       kernel->source);
    BB_TRY(bb_program_build(traverser->device, source, defines, &traverser->program));
    BB_TRY(bb_kernel_get(traverser->program, "trace", &traverser->kernel));
    size_t group = traverser->group;
    if (!traverser->batched)
        BB_TRY(bb_kernel_group(traverser->device, traverser->kernel, group, &group));
    traverser->group = (uint32_t)group;
    bb_ray_order *order;
    if (traverser->sorted)
        BB_TRY(bb_ray_order_of(traverser->device, &order)); /* compiles it */
    return traverser->persistent ? bb_buffer_reserve(traverser->device, NULL, sizeof(cl_uint),
                                                     "rays taken", &traverser->taken)
                                 : BB_OK;
}

bb_status bb_traverser_get(bb_device *device, const bb_traverser_request *request,
                           const bb_layout_data *layout, bb_traverser **out)
{
    variant v;
    uint64_t group;
    char defines[768], key[sizeof((bb_traverser *)NULL)->key] = "";
    BB_TRY(check_request(request, layout));
    BB_TRY(bb_kernel_group_of(request->kernel, request->spec, device, &group));
    BB_TRY(choose_variant(device, request, layout, &v));
    BB_TRY(write_defines(device, request, layout, &v, (uint32_t)group, defines, sizeof defines));
    BB_TRY(append(key, sizeof key, "%s %u %s", request->kernel->source, (unsigned)group, defines));
    for (bb_traverser *traverser = cache; traverser != NULL; traverser = traverser->next)
        if (traverser->device == device && strcmp(traverser->key, key) == 0) {
            *out = traverser;
            return BB_OK;
        }

    bb_traverser *traverser = malloc(sizeof *traverser);
    if (traverser == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *traverser = (bb_traverser){
        .device = device,
        .group = (uint32_t)group,
        .stack_size = v.stack_size,
        .stacks = bb_stacks_of_item(request->kernel, request->spec),
        .counting = request->counting || request->recording,
        .recording = request->recording,
        .persistent = is_persistent(request),
        .batched = request->kernel->batched,
        .sorted = is_sorted(request),
        .format = bb_intersector_format(request->intersector),
        .lanes = layout->lanes,
    };
    memcpy(traverser->key, key, sizeof key);
    bb_status status = compile(traverser, request->kernel, defines);
    if (status != BB_OK) {
        release(traverser);
        return status;
    }
    traverser->next = cache;
    cache = traverser;
    *out = traverser;
    return BB_OK;
}

void bb_traversers_clear(bb_device *device)
{
    for (bb_traverser **link = &cache; *link != NULL;) {
        bb_traverser *traverser = *link;
        if (traverser->device != device) {
            link = &traverser->next;
            continue;
        }
        *link = traverser->next;
        release(traverser);
    }
    bb_ray_order_clear(device);
}

uint32_t bb_traverser_group_size(const bb_traverser *traverser)
{
    return traverser->group;
}

uint32_t bb_traverser_stack_size(const bb_traverser *traverser)
{
    return traverser->stack_size;
}

uint64_t bb_traverser_stack_bytes(const bb_traverser *traverser)
{
    return (uint64_t)traverser->stack_size * traverser->stacks * BB_STACK_ENTRY_BYTES;
}

bool bb_traverser_private_bytes(const bb_traverser *traverser, uint64_t *bytes)
{
    cl_ulong private_bytes = 0;
    if (clGetKernelWorkGroupInfo(traverser->kernel, traverser->device->id,
                                 CL_KERNEL_PRIVATE_MEM_SIZE, sizeof private_bytes, &private_bytes,
                                 NULL) != CL_SUCCESS)
        return false;
    *bytes = private_bytes;
    return private_bytes > 0; /* PoCL and others report 0 instead */
}

uint64_t bb_traverser_launched(const bb_traverser *traverser)
{
    return traverser->launched;
}

bool bb_traverser_sorts(const bb_traverser *traverser)
{
    return traverser->sorted;
}

bb_status bb_traverser_sort(bb_traverser *traverser, const bb_layout_data *layout,
                            const bb_buffer *rays, uint32_t count)
{
    bb_ray_order *order;
    BB_TRY(bb_ray_order_of(traverser->device, &order));
    return bb_ray_order_make(order, traverser, &layout->bounds, rays, count);
}

bb_status bb_traverser_launch(bb_traverser *traverser, const bb_layout_data *layout,
                              const bb_buffer *rays, uint32_t count, bb_buffer *results,
                              bb_buffer *counts, const bb_recording *recording, const bb_arg *more,
                              uint32_t more_count)
{
    assert(layout->format == traverser->format && layout->lanes == traverser->lanes &&
           more_count <= BB_MORE_ARGS_MAX);
    bb_device *device = traverser->device;
    const bb_buffer *ids = NULL;
    if (traverser->sorted) {
        bb_ray_order *order;
        BB_TRY(bb_ray_order_of(device, &order));
        BB_TRY(bb_ray_order_take(order, traverser, count, &ids));
    }
    traverser->launched += count;
    bb_arg args[BB_LAYOUT_BUFFERS_MAX + 12 + BB_MORE_ARGS_MAX];
    uint32_t n = 0;
    for (uint32_t i = 0; i < layout->buffer_count; i++)
        args[n++] = BB_MEM(layout->buffers[i]);
    args[n++] = BB_VALUE(layout->root);
    args[n++] = BB_VALUE(layout->ends);
    args[n++] = BB_VALUE(layout->scale);
    args[n++] = BB_MEM(*rays);
    args[n++] = BB_VALUE(count);
    if (ids != NULL)
        args[n++] = BB_MEM(*ids);
    args[n++] = BB_MEM(*results);
    if (traverser->counting)
        args[n++] = BB_MEM(*counts);
    if (traverser->recording) {
        args[n++] = BB_MEM(recording->ends);
        args[n++] = BB_MEM(recording->steps);
        args[n++] = BB_MEM(recording->counts);
    }
    if (traverser->persistent)
        args[n++] = BB_MEM(traverser->taken);
    for (uint32_t i = 0; i < more_count; i++)
        args[n++] = more[i];
    uint32_t local = traverser->batched ? 1 : traverser->group;
    uint32_t items = traverser->batched ? (count - 1) / traverser->group + 1 : count;
    if (!traverser->persistent)
        return bb_launch_args(device, traverser->kernel, items, local, args, n);
    BB_TRY(bb_buffer_fill(&traverser->taken, sizeof(cl_uint), 0));
    uint64_t most = (uint64_t)device->compute_units * GROUPS_PER_UNIT * local;
    return bb_launch_args(device, traverser->kernel, most < items ? most : items, local, args, n);
}
