/* cheat: halves the primitives in their given order, in a few milliseconds, and cheats as told: it
 * remembers trees, leaves work behind, writes into its input, hides memory. For the tests of what
 * finds that out; kind=right does not cheat.
 */
#include "builders/common/refit.h"
#include "framework/builder/builder.h"

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum {
    WORK_US = 4000,
    LATE_US = 30000,
    MEMORIES = 16,
    HIDDEN = 96 << 20,
};

/* A tree, and the input that it was built from. */
typedef struct memory {
    uint64_t hash;
    bb_node *nodes;
} memory;

/* What kind=refuses keeps beyond an object that is destroyed for its refusal. */
static struct {
    memory memories[MEMORIES];
    uint32_t count;
} kept;

typedef struct cheat {
    bb_device *device;
    const char *kind;
    memory memories[MEMORIES];
    uint32_t memory_count, builds, copies;
    uint32_t *order;
    char *hidden;
    /* of the thread that goes on */
    pthread_t thread;
    bool has_thread;
    atomic_bool stop;
    bb_tree *tree;
    bb_box *boxes;
    pid_t child;
    uint64_t first_hash;
    bb_box *input; /* last-boxes */
} cheat;

static const bb_option options[] = {
    {"kind", "right",
     "right|content|sleeper|repents|refuses|first|prepared|early|spins|late|process|boxes|device-"
     "boxes|"
     "new-boxes|last-boxes|hides",
     "content: a tree that it has built before is copied; sleeper: likewise, and its second copy "
     "is slow; repents: likewise, but builds from its third input on; refuses: likewise, for lack "
     "of memory that it does not lack when it sees an input again; first: always its first tree; "
     "prepared: prepare() builds, build() copies; early: a "
     "thread builds after it has returned; spins, late: a thread works after the third build, at "
     "once or 30 ms later; process: that build leaves one behind; boxes, device-boxes: it writes "
     "into them; new-boxes: only into those that it has not seen; last-boxes: in destroy(), after "
     "its third build has failed; hides: 96 MiB that it has not booked"},
    {.name = NULL},
};

static bool is(const cheat *self, const char *kind)
{
    return strcmp(self->kind, kind) == 0;
}

static void work(uint32_t us)
{
    struct timespec start, now;
    clock_gettime(CLOCK_MONOTONIC, &start);
    do
        clock_gettime(CLOCK_MONOTONIC, &now);
    while ((now.tv_sec - start.tv_sec) * 1000000 + (now.tv_nsec - start.tv_nsec) / 1000 < us);
}

static bb_status create(const bb_builder_context *context, void **out)
{
    cheat *self = NULL;
    BB_TRY(bb_host_alloc(context->account, sizeof *self, "cheat: object", &self));
    *self =
        (cheat){.device = context->device, .kind = bb_spec_value(context->spec, options, "kind")};
    if (is(self, "refuses")) {
        memcpy(self->memories, kept.memories, sizeof kept.memories);
        self->memory_count = kept.count;
    }
    *out = self;
    return BB_OK;
}

static void destroy(void *opaque)
{
    cheat *self = opaque;
    self->stop = true;
    if (self->has_thread)
        pthread_join(self->thread, NULL);
    if (self->child > 0)
        kill(self->child, SIGKILL);
    if (self->input != NULL)
        self->input->hi[0] += 1;
    if (is(self, "refuses")) {
        memcpy(kept.memories, self->memories, sizeof kept.memories);
        kept.count = self->memory_count;
    }
    for (uint32_t i = 0; i < self->memory_count && !is(self, "refuses"); i++)
        free(self->memories[i].nodes);
    free(self->hidden);
    free(self->boxes);
    bb_host_free(self->order);
    bb_host_free(self);
}

typedef struct range {
    uint32_t begin, end, node, skip, depth;
} range;

/* The links of a tree of `count` primitives, without boxes. */
static void link_nodes(uint32_t count, bb_tree *tree)
{
    range stack[64] = {{0, count, 0, BB_NONE, 0}};
    tree->info = (bb_tree_info){.node_count = 2 * count - 1,
                                .leaf_count = count,
                                .ref_count = count,
                                .arity = count > 1 ? 2 : 0};
    for (uint32_t top = 1; top > 0;) {
        const range r = stack[--top];
        bb_node *node = &tree->nodes[r.node];
        node->skip = r.skip;
        if (r.end - r.begin == 1) {
            node->first = BB_LEAF_BIT | r.begin;
            tree->refs[r.begin] = r.begin | BB_LAST_BIT;
            tree->info.depth = r.depth > tree->info.depth ? r.depth : tree->info.depth;
            continue;
        }
        const uint32_t middle = r.begin + (r.end - r.begin) / 2;
        const uint32_t left = r.node + 1, right = r.node + 2 * (middle - r.begin);
        node->first = left;
        stack[top++] = (range){middle, r.end, right, r.skip, r.depth + 1};
        stack[top++] = (range){r.begin, middle, left, right, r.depth + 1};
    }
}

static bb_status reserve(const cheat *self, uint32_t count, bb_tree *tree)
{
    BB_TRY(bb_tree_reserve(tree, self->device, BB_ON_HOST, 2 * (size_t)count - 1, count));
    link_nodes(count, tree);
    return BB_OK;
}

static bb_status make(cheat *self, const bb_box *boxes, uint32_t count, bb_tree *tree)
{
    BB_TRY(reserve(self, count, tree));
    BB_TRY(bb_host_alloc(NULL, (2 * (size_t)count - 1) * sizeof *self->order, "cheat: order",
                         &self->order));
    work(WORK_US);
    return bb_refit(tree, boxes, count, self->order);
}

/* FNV-1a. */
static uint64_t hash_of(const bb_scene *scene)
{
    const unsigned char *at = (const unsigned char *)scene->boxes;
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < scene->prim_count * sizeof *scene->boxes; i++)
        hash = (hash ^ at[i]) * 0x100000001b3u;
    return hash;
}

static size_t node_bytes(const bb_tree *tree)
{
    return tree->info.node_count * sizeof *tree->nodes;
}

/* Copies the tree if it was built before; else builds it. `any`: whatever the input. */
static bb_status recall(cheat *self, const bb_scene *scene, bool any, bb_tree *tree)
{
    const uint64_t hash = any ? 0 : hash_of(scene);
    const bool repents = is(self, "repents") && self->memory_count >= 3;
    for (uint32_t i = 0; i < self->memory_count && !repents; i++)
        if (self->memories[i].hash == hash) {
            BB_TRY(reserve(self, scene->prim_count, tree));
            memcpy(tree->nodes, self->memories[i].nodes, node_bytes(tree));
            if (is(self, "sleeper") && ++self->copies == 2)
                usleep(4 * WORK_US);
            return BB_OK;
        }
    BB_TRY(make(self, scene->boxes, scene->prim_count, tree));
    if (self->memory_count < MEMORIES) {
        memory *m = &self->memories[self->memory_count++];
        *m = (memory){hash, malloc(node_bytes(tree))};
        memcpy(m->nodes, tree->nodes, node_bytes(tree));
    }
    return BB_OK;
}

/* Learns an input and refuses it, but for the first. */
static bb_status refuse_new(cheat *self, const bb_scene *scene, bb_tree *tree)
{
    const uint32_t known = self->memory_count;
    BB_TRY(recall(self, scene, false, tree));
    return known > 0 && self->memory_count > known
               ? bb_fail(BB_REFUSED, "cheat: no memory, it says")
               : BB_OK;
}

static bb_status prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    cheat *self = opaque;
    return is(self, "prepared") ? recall(self, scene, true, tree) : BB_OK;
}

/* ---- what goes on after build() ---- */

static void *finish_tree(void *opaque)
{
    cheat *self = opaque;
    (void)make(self, self->boxes, self->tree->info.ref_count, self->tree);
    return NULL;
}

static void *spin(void *opaque)
{
    cheat *self = opaque;
    if (is(self, "late"))
        usleep(LATE_US);
    while (!self->stop)
        work(100);
    return NULL;
}

static bb_status start(cheat *self, void *(*what)(void *))
{
    if (self->has_thread)
        pthread_join(self->thread, NULL);
    self->has_thread = pthread_create(&self->thread, NULL, what, self) == 0;
    return self->has_thread ? BB_OK : bb_fail(BB_FAILED, "cheat: no thread");
}

/* Its first build is as it should be, so that there is a tree. */
static bb_status leave_to_thread(cheat *self, const bb_scene *scene, bb_tree *tree)
{
    if (self->builds == 1)
        return make(self, scene->boxes, scene->prim_count, tree);
    if (self->boxes == NULL)
        self->boxes = malloc(scene->prim_count * sizeof *self->boxes);
    memcpy(self->boxes, scene->boxes, scene->prim_count * sizeof *self->boxes);
    self->tree = tree;
    return start(self, finish_tree);
}

static bb_status leave_behind(cheat *self)
{
    if (self->builds != 3)
        return BB_OK;
    if (is(self, "spins") || is(self, "late"))
        return start(self, spin);
    if (is(self, "process") && (self->child = fork()) == 0)
        for (;;)
            pause();
    return BB_OK;
}

/* ---- what it writes ---- */

static bb_status write_input(cheat *self, const bb_scene *scene)
{
    bb_buffer buffer = scene->on_device.boxes;
    bb_box box = scene->boxes[0];
    box.hi[0] += 1;
    if (self->builds == 1)
        self->first_hash = hash_of(scene);
    const bool is_new = is(self, "new-boxes") && hash_of(scene) != self->first_hash;
    if (is(self, "boxes") || is_new)
        memcpy((void *)(uintptr_t)scene->boxes, &box, sizeof box);
    if (is(self, "last-boxes") && self->builds == 3) {
        self->input = (bb_box *)(uintptr_t)scene->boxes;
        return bb_fail(BB_FAILED, "cheat: gives up");
    }
    return is(self, "device-boxes") ? bb_buffer_write(&buffer, 0, sizeof box, &box) : BB_OK;
}

static void hide(cheat *self)
{
    if (self->hidden != NULL)
        return;
    self->hidden = malloc(HIDDEN);
    memset(self->hidden, 1, HIDDEN);
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)input;
    cheat *self = opaque;
    self->builds++;
    BB_TRY(bb_phase(phases, "halve"));
    if (is(self, "content") || is(self, "sleeper") || is(self, "repents"))
        BB_TRY(recall(self, scene, false, tree));
    else if (is(self, "refuses"))
        BB_TRY(refuse_new(self, scene, tree));
    else if (is(self, "first") || is(self, "prepared"))
        BB_TRY(recall(self, scene, true, tree));
    else if (is(self, "early"))
        BB_TRY(leave_to_thread(self, scene, tree));
    else
        BB_TRY(make(self, scene->boxes, scene->prim_count, tree));
    BB_TRY(leave_behind(self));
    BB_TRY(write_input(self, scene));
    if (is(self, "hides"))
        hide(self);
    return bb_phase(phases, NULL);
}

const bb_builder bb_builder_cheat = {
    .abi_version = BB_ABI_VERSION,
    .name = "cheat",
    .summary = "cheats, as told; for tests",
    .paper = "none",
    .kinds = BB_ALL_KINDS,
    .inputs = BB_INPUT_BOXES,
    .place = BB_ON_HOST,
    .deterministic = true,
    .options = options,
    .create = create,
    .prepare = prepare,
    .build = build,
    .destroy = destroy,
};
