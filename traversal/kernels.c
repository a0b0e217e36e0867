/* Kernels by name, and what their specifications ask for. */
#include "framework/base/number.h"
#include "framework/base/suggest.h"
#include "traversal/traversal.h"

#include <stdio.h>
#include <string.h>

const bb_option bb_kernel_common_options[] = {
    {"leaf", "1", NULL,
     "collapse subtrees of up to this many references into a leaf where that lowers SAH; trees "
     "whose "
     "nodes are kept keep their leaves, too (see plan)"},
    {"group", "64", NULL, "work-group size, in rays"},
    /* no defaults, so that keys of earlier cells stay the same */
    {"stack", NULL, "auto|4|8|16|32|64|128|256|512|1024",
     "entries of the stack; auto, or not given: what the tree needs, rounded up, 16 at least"},
    {"kinds", NULL, "scene|all", "kinds of primitives compiled in; default: the scene's"},
    {"plan", NULL, "optimal|greedy|native",
     "nodes of more than two children: of least area in all, by opening the largest child, or the "
     "tree's own with its own leaves; default: native for trees made for it, else optimal"},
    {"node", NULL, NULL,
     "cost of a node for leaf=N, relative to a block of primitives; default: "
     "1.2 per pair of children"},
    {"persistent", "no", "no|yes",
     "as many groups as fit the device, which fetch rays from a counter: for GPUs"},
    {"sort", NULL, "no|yes",
     "rays are sorted first, by octant and by Morton code of the origin, inside the clock; "
     "default: "
     "no"},
    {.name = NULL},
};

static const double NODE_COST_LEAST = 0.001, NODE_COST_MOST = 1000;

const bb_kernel *bb_kernel_find(const char *name)
{
    for (const bb_kernel *const *k = bb_kernels; *k != NULL; k++)
        if (strcmp((*k)->name, name) == 0)
            return *k;
    return NULL;
}

uint32_t bb_kernel_recorded_packet(const bb_kernel *kernel, const bb_spec *spec)
{
    if (kernel->control != BB_PACKETS)
        return 1;
    /* not as many as the device's vectors have lanes: the same on all devices */
    return bb_spec_is(spec, kernel->options, "rays", "16") ? 16 : 8;
}

bool bb_kernel_records(const bb_kernel *kernel, const bb_query *query)
{
    return query->is_recorded && kernel->control != BB_CONTROL_UNKNOWN &&
           (kernel->control != BB_PACKETS || query->is_hit);
}

bool bb_kernel_is_for_cpus(const bb_kernel *kernel)
{
    uint32_t devices = 0;
    for (const bb_variants *v = kernel->variants; v != NULL && v->devices != 0; v++)
        devices |= v->devices;
    return devices == BB_FOR_CPU;
}

const bb_kernel *bb_kernel_for_any_leaf(bool recorded)
{
    const bb_kernel *const *k = bb_kernels;
    while (bb_layout_find((*k)->layout)->leaf_max > 0 ||
           (recorded && ((*k)->control == BB_CONTROL_UNKNOWN || bb_kernel_is_for_cpus(*k))))
        k++;
    return *k;
}

bb_status bb_kernel_validate(const bb_kernel *kernel, const bb_spec *spec)
{
    bb_option all[BB_PARAMS_MAX + 1];
    uint32_t count = 0;
    for (const bb_option *o = bb_kernel_common_options; o->name != NULL; o++)
        all[count++] = *o;
    for (const bb_option *o = kernel->options; o != NULL && o->name != NULL; o++)
        all[count++] = *o;
    all[count] = (bb_option){.name = NULL};
    char what[96];
    snprintf(what, sizeof what, "kernel %s", kernel->name);
    BB_TRY(bb_spec_validate(spec, all, what));
    if (kernel->stackless && bb_spec_value(spec, NULL, "stack") != NULL)
        return bb_fail(BB_INVALID, "%s has no stack of the tree's size: drop stack=", what);
    const bb_layout *layout = bb_layout_find(kernel->layout);
    if (layout->width == 2 && bb_spec_value(spec, NULL, "plan") != NULL)
        return bb_fail(BB_INVALID,
                       "%s has no nodes of more than two children to plan: drop plan=", what);
    if (!layout->keeps_nodes && bb_spec_is(spec, NULL, "plan", "native"))
        return bb_fail(BB_INVALID,
                       "%s: compressed nodes are made in other ways: leave out plan=native", what);
    uint64_t leaf;
    double node;
    BB_TRY(bb_spec_u64(spec, all, "leaf", 1, BB_LEAF_MAX, &leaf));
    if (leaf > bb_layout_leaf_max(layout))
        return bb_fail(BB_INVALID, "%s: leaf=%u at most, its nodes have no room for more: not %u",
                       what, bb_layout_leaf_max(layout), (unsigned)leaf);
    if (bb_spec_value(spec, NULL, "node") == NULL)
        return BB_OK;
    BB_TRY(bb_spec_double(spec, all, "node", NODE_COST_LEAST, NODE_COST_MOST, &node));
    if (leaf == 1)
        return bb_fail(BB_INVALID, "%s: node= decides which leaves become one: give leaf=N", what);
    return BB_OK;
}

bb_layout_wish bb_kernel_wish(const bb_spec *spec)
{
    const char *node = bb_spec_value(spec, NULL, "node");
    double node_cost = 0;
    if (node != NULL && !bb_read_real(node, &node_cost))
        node_cost = 0; /* bb_kernel_validate() refuses it */
    return (bb_layout_wish){
        .kinds = bb_spec_is(spec, NULL, "kinds", "all") ? BB_ALL_KINDS : 0,
        .octants = bb_spec_is(spec, NULL, "order", "octant"),
        .plan = bb_spec_is(spec, NULL, "plan", "optimal")  ? BB_PLAN_OPTIMAL
                : bb_spec_is(spec, NULL, "plan", "greedy") ? BB_PLAN_GREEDY
                : bb_spec_is(spec, NULL, "plan", "native") ? BB_PLAN_NATIVE
                                                           : BB_PLAN_BY_TREE,
        .node_cost = node_cost,
    };
}

bool bb_layout_wish_is(const bb_layout_wish *a, const bb_layout_wish *b)
{
    return a->kinds == b->kinds && a->octants == b->octants && a->plan == b->plan &&
           a->node_cost == b->node_cost && a->preorder == b->preorder;
}

bb_status bb_kernel_parse(const char *text, bb_spec *spec, const bb_kernel **kernel)
{
    BB_TRY(bb_spec_parse(text, spec));
    *kernel = bb_kernel_find(spec->name);
    if (*kernel != NULL)
        return bb_kernel_validate(*kernel, spec);
    bb_suggestion meant = {.word = spec->name};
    for (const bb_kernel *const *k = bb_kernels; *k != NULL; k++)
        bb_suggest(&meant, (*k)->name);
    return bb_fail(BB_INVALID, "unknown kernel '%s'%s: `bvhbench list kernels` shows them",
                   spec->name, bb_suggested(&meant));
}

/* Rays that one work-item of a batched kernel traces; the device sets no bound. */
enum { BATCH_MAX = 4096 };

bb_status bb_kernel_group_of(const bb_kernel *kernel, const bb_spec *spec, const bb_device *device,
                             uint64_t *group)
{
    const uint64_t most = kernel->batched ? BATCH_MAX : device->max_group_size;
    const bool given = bb_spec_value(spec, NULL, "group") != NULL;
    BB_TRY(
        bb_spec_u64(spec, bb_kernel_common_options, "group", 1, given ? most : BATCH_MAX, group));
    if (*group > most)
        *group = most;
    return BB_OK;
}
