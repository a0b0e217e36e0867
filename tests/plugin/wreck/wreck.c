/* wreck: one leaf over everything, which is right, until a scene has more primitives than it is
 * told; then it goes wrong in the manner it is told. For the tests of `stress`, and of the death of
 * a builder in each of its hooks. */
#include "framework/builder/builder.h"

#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const bb_option options[] = {
    {"above", "100", NULL, "primitives from which on all goes wrong"},
    {"how", "right",
     "right|crash|exit|exit0|overflow|beside|atexit|sigpipe|term|late|tire|hang|spin|xcpu|orphan|"
     "flood|"
     "wrong|refuse|fail|slow|big",
     "what goes wrong"},
    {"at", "build", "create|prepare|restore|build|describe|decide|destroy",
     "in which hook; in others than build only crash, exit, exit0, overflow, beside and hang, in "
     "any "
     "scene"},
    {.name = NULL},
};

static unsigned builds; /* late, tire: in this process */

typedef struct wreck {
    const bb_builder_context *context;
    uint64_t above;
    void *more; /* big: what it takes */
} wreck;

/* Fills the stack. */
static int overflow(volatile int *depth)
{
    volatile int more[1024];
    more[0] = *depth + 1;
    return more[0] < 0 ? 0 : overflow(more) + more[0];
}

static void *abort_soon(void *none)
{
    usleep(30000);
    abort();
    return none;
}

static void leave(void)
{
    _exit(0);
}

/* Leaves a process that is in no group and session of ours, and its id in the working folder. */
static void leave_orphan(void)
{
    if (fork() != 0)
        return;
    setsid();
    const pid_t orphan = fork();
    FILE *file = orphan > 0 ? fopen("orphan.new", "w") : NULL;
    if (file != NULL && fprintf(file, "%ld", (long)orphan) > 0 && fclose(file) == 0)
        rename("orphan.new", "orphan.pid"); /* it is there when its content is */
    if (orphan == 0)
        sleep(600);
    _exit(0);
}

static void die(const char *how)
{
    for (volatile unsigned spin = 0; strcmp(how, "spin") == 0; spin++)
        ;
    if (strcmp(how, "xcpu") == 0) {
        signal(SIGXCPU, SIG_DFL); /* LLVM's returns from the first one */
        raise(SIGXCPU);
    }
    if (strcmp(how, "orphan") == 0) {
        leave_orphan();
        while (access("orphan.pid", F_OK) != 0)
            usleep(1000);
        abort();
    }
    if (strcmp(how, "atexit") == 0)
        atexit(leave);
    if (strcmp(how, "sigpipe") == 0) {
        signal(SIGPIPE, SIG_DFL);
        raise(SIGPIPE);
    }
    pthread_t thread;
    if (strcmp(how, "beside") == 0 && pthread_create(&thread, NULL, abort_soon, NULL) == 0)
        pthread_detach(thread);
    if (strcmp(how, "crash") == 0)
        abort();
    if (strcmp(how, "exit") == 0)
        exit(3);
    if (strcmp(how, "exit0") == 0)
        exit(0);
    if (strcmp(how, "overflow") == 0)
        overflow(&(int){0});
    while (strcmp(how, "hang") == 0)
        usleep(1000);
}

static void die_at(const bb_spec *spec, const char *hook)
{
    if (strcmp(bb_spec_value(spec, options, "at"), hook) == 0 && strcmp(hook, "build") != 0)
        die(bb_spec_value(spec, options, "how"));
}

static bb_status create(const bb_builder_context *context, void **out)
{
    wreck *self = NULL;
    BB_TRY(bb_host_alloc(context->account, sizeof *self, "wreck: object", &self));
    *self = (wreck){.context = context};
    *out = self;
    die_at(context->spec, "create");
    return bb_spec_u64(context->spec, options, "above", 1, UINT32_MAX, &self->above);
}

static void destroy(void *opaque)
{
    wreck *self = opaque;
    if (self != NULL) {
        die_at(self->context->spec, "destroy");
        bb_host_free(self->more);
    }
    bb_host_free(self);
}

static void flood(void)
{
    for (;;) {
        volatile char *block = malloc(1 << 24);
        for (size_t i = 0; block != NULL && i < 1 << 24; i += 4096)
            block[i] = 1;
    }
}

static bb_status go_wrong(wreck *self, const char *how, bb_tree *tree)
{
    die(how);
    if (strcmp(how, "term") == 0)
        kill(getpid(), SIGTERM);
    if (strcmp(how, "late") == 0 && ++builds > 5)
        abort();
    if (strcmp(how, "tire") == 0 && ++builds > 5) {
        usleep(500000);
        return bb_fail(BB_FAILED, "wreck: it is tired, as told");
    }
    if (strcmp(how, "flood") == 0)
        flood();
    if (strcmp(how, "refuse") == 0)
        return bb_fail(BB_REFUSED, "wreck: more than %llu are too many for it",
                       (unsigned long long)self->above);
    if (strcmp(how, "fail") == 0)
        return bb_fail(BB_FAILED, "wreck: it fails, as told");
    if (strcmp(how, "slow") == 0)
        usleep(20000);
    if (strcmp(how, "big") == 0 && self->more == NULL)
        return bb_host_alloc(self->context->account, 1 << 20, "wreck: more", &self->more);
    if (strcmp(how, "wrong") == 0) /* half of the scene is not in the box */
        tree->nodes[0].hi[0] = 0.5f * tree->nodes[0].lo[0] + 0.5f * tree->nodes[0].hi[0];
    return BB_OK;
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)input;
    wreck *self = opaque;
    const uint32_t count = scene->prim_count;
    BB_TRY(bb_phase(phases, "leaf"));
    BB_TRY(bb_tree_reserve(tree, self->context->device, BB_ON_HOST, 1, count));
    tree->info = (bb_tree_info){.node_count = 1, .leaf_count = 1, .ref_count = count};
    bb_node *root = &tree->nodes[0];
    *root = (bb_node){.first = BB_LEAF_BIT, .skip = BB_NONE};
    for (int k = 0; k < 3; k++) {
        root->lo[k] = INFINITY;
        root->hi[k] = -INFINITY;
        for (uint32_t i = 0; i < count; i++) {
            root->lo[k] = fminf(root->lo[k], scene->boxes[i].lo[k]);
            root->hi[k] = fmaxf(root->hi[k], scene->boxes[i].hi[k]);
        }
    }
    for (uint32_t i = 0; i < count; i++)
        tree->refs[i] = i | (i + 1 == count ? BB_LAST_BIT : 0);
    if (count > self->above &&
        strcmp(bb_spec_value(self->context->spec, options, "at"), "build") == 0)
        BB_TRY(go_wrong(self, bb_spec_value(self->context->spec, options, "how"), tree));
    return bb_phase(phases, NULL);
}

static bb_status prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    (void)scene;
    (void)tree;
    die_at(((wreck *)opaque)->context->spec, "prepare");
    return BB_OK;
}

static bb_status restore(void *opaque, const bb_scene *scene)
{
    (void)scene;
    die_at(((wreck *)opaque)->context->spec, "restore");
    return BB_OK;
}

static bb_status describe(void *opaque, const bb_scene *scene, char *text, size_t capacity)
{
    (void)scene;
    (void)text;
    (void)capacity;
    die_at(((wreck *)opaque)->context->spec, "describe");
    return BB_OK;
}

static void decide(void *opaque, const bb_scene *scene, bb_decisions *decisions)
{
    (void)scene;
    (void)decisions;
    die_at(((wreck *)opaque)->context->spec, "decide");
}

const bb_builder bb_builder_wreck = {
    .abi_version = BB_ABI_VERSION,
    .name = "wreck",
    .summary = "goes wrong in large scenes, as told; for tests",
    .paper = "none",
    .kinds = BB_TRIANGLES,
    .inputs = BB_INPUT_BOXES,
    .place = BB_ON_HOST,
    .deterministic = true,
    .options = options,
    .create = create,
    .build = build,
    .prepare = prepare,
    .restore = restore,
    .describe = describe,
    .decide = decide,
    .destroy = destroy,
};
