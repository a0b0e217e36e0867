/* rogue: halves the primitives in their given order, and breaks one rule of builders, as told. For
 * the tests of what finds that out; kind=right breaks none.
 */
#include "builders/common/refit.h"
#include "framework/builder/builder.h"

#include <fcntl.h>
#include <fenv.h>
#include <locale.h>
#include <sched.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

enum { WORK_US = 20000, STACK_MAX = 64 };

typedef struct rogue {
    bb_device *device;
    bool stale, moving, chain, nosy, early, marked, lopsided;
    bool follows, still, forgets; /* has an update() */
    bool frozen, hangs;
    const char *term, *at; /* what it changes of the process, and in which hook */
    bb_box *kept;          /* frozen: what prepare() saw */
    bool sees_views;       /* `view` was given */
    uint32_t builds;
} rogue;

static const bb_option options[] = {
    {"kind", "right",
     "right|stale|moving|chain|nosy|early|marked|form|follows|still|forgets|frozen|hangs",
     "stale: gives its first tree again and again; moving: another one each time; chain: one "
     "primitive "
     "per level; nosy: fails if it sees what it did not declare; early: works outside the clock; "
     "marked: a side array that is another one each time; form: another tree in form gpu; "
     "follows: refits, which is right; still: does nothing in place of that; forgets: a node; "
     "frozen: builds over the boxes that it was prepared with; hangs: never ends"},
    {"term", "none",
     "none|rounding|denormals|sse-rounding|x87-rounding|x87-precision|locale|thread-locale|handler|"
     "handler-restart|handler-stack|handler-children|mask|limit|processors|folder|umask|"
     "alarm|virtual-timer|profile-timer|own-timers|no-input|error|"
     "environment|variable|variable-text|variable-order|no-variable|no-variables",
     "changes this of the process"},
    {"at", "build", "create|prepare|restore|build|describe|decide|destroy", "in this hook"},
    {"view", NULL, NULL, "a view to look at"},
    {.name = NULL},
};

static void ignore(int signal)
{
    (void)signal;
}

static void change_floats(const char *term)
{
    if (strcmp(term, "rounding") == 0)
        fesetround(FE_UPWARD);
#if defined(__SSE__)
    if (strcmp(term, "denormals") == 0)
        _mm_setcsr(_mm_getcsr() | 0x8040u);
    if (strcmp(term, "sse-rounding") == 0)
        _mm_setcsr(_mm_getcsr() | 0x4000u);
    uint16_t x87;
    __asm__ volatile("fnstcw %0" : "=m"(x87));
    if (strcmp(term, "x87-rounding") == 0)
        x87 |= 0x0800u;
    if (strcmp(term, "x87-precision") == 0)
        x87 &= (uint16_t)~0x0100u;
    __asm__ volatile("fldcw %0" : : "m"(x87));
#endif
}

static void toggle(int signal_number, int flag)
{
    struct sigaction action;
    sigaction(signal_number, NULL, &action);
    action.sa_flags ^= flag;
    sigaction(signal_number, &action, NULL);
}

static void change_signals(const char *term)
{
    if (strcmp(term, "handler") == 0)
        signal(SIGUSR2, ignore);
    if (strcmp(term, "handler-restart") == 0)
        toggle(SIGUSR1, SA_RESTART);
    if (strcmp(term, "handler-stack") == 0)
        toggle(SIGUSR1, SA_ONSTACK);
    if (strcmp(term, "handler-children") == 0)
        toggle(SIGCHLD, SA_NOCLDWAIT);
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGUSR1);
    if (strcmp(term, "mask") == 0)
        sigprocmask(SIG_BLOCK, &set, NULL);
}

/* They would ring in an hour. */
static void change_timers(const char *term)
{
    const struct itimerval hour = {.it_value.tv_sec = 3600};
    if (strcmp(term, "alarm") == 0)
        alarm(3600);
    if (strcmp(term, "virtual-timer") == 0)
        setitimer(ITIMER_VIRTUAL, &hour, NULL);
    if (strcmp(term, "profile-timer") == 0)
        setitimer(ITIMER_PROF, &hour, NULL);
    timer_t timer;
    struct sigevent event = {.sigev_notify = SIGEV_SIGNAL, .sigev_signo = SIGUSR2};
    for (int i = 0; i < 2 && strcmp(term, "own-timers") == 0; i++)
        timer_create(CLOCK_MONOTONIC, &event, &timer);
}

static void change_streams(const char *term)
{
    if (strcmp(term, "no-input") == 0)
        close(STDIN_FILENO);
    const int zero = open("/dev/zero", O_RDWR | O_CLOEXEC);
    if (strcmp(term, "error") == 0)
        dup2(zero, STDERR_FILENO);
    if (zero > STDERR_FILENO)
        close(zero);
}

/* The test that asks for it has put BVHBENCH_PUT there. */
static void change_environment(const char *term)
{
    if (strcmp(term, "environment") == 0)
        setenv("BVHBENCH_ROGUE", "was here", 1);
    if (strcmp(term, "variable") == 0)
        setenv("BVHBENCH_PUT", "rogue", 1);
    if (strcmp(term, "variable-text") == 0)
        *getenv("BVHBENCH_PUT") = '\0';
    if (strcmp(term, "variable-order") == 0) {
        char *first = environ[0];
        environ[0] = environ[1];
        environ[1] = first;
    }
    if (strcmp(term, "no-variable") == 0)
        unsetenv("BVHBENCH_PUT");
    if (strcmp(term, "no-variables") == 0)
        clearenv();
}

static void change(const char *term)
{
    change_floats(term);
    change_signals(term);
    if (strcmp(term, "locale") == 0)
        setlocale(LC_ALL, "");
    static locale_t own; /* kept: the thread may use it */
    if (own == (locale_t)0)
        own = newlocale(LC_ALL_MASK, "C.UTF-8", (locale_t)0);
    if (strcmp(term, "thread-locale") == 0)
        uselocale(own);
    struct rlimit limit;
    getrlimit(RLIMIT_CORE, &limit);
    limit.rlim_cur = limit.rlim_cur == 0 ? 1 : 0;
    if (strcmp(term, "limit") == 0)
        setrlimit(RLIMIT_CORE, &limit);
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(sched_getcpu(), &one);
    if (strcmp(term, "processors") == 0)
        sched_setaffinity(0, sizeof one, &one);
    if (strcmp(term, "folder") == 0 && chdir("/") != 0)
        abort();
    if (strcmp(term, "umask") == 0)
        umask(0777);
    change_timers(term);
    change_streams(term);
    change_environment(term);
}

static void meddle(const rogue *self, const char *hook)
{
    if (strcmp(self->at, hook) == 0)
        change(self->term);
}

static bb_status create(const bb_builder_context *context, void **out)
{
    rogue *self = NULL;
    BB_TRY(bb_host_alloc(context->account, sizeof *self, "rogue: object", &self));
    *self = (rogue){
        .device = context->device,
        .stale = bb_spec_is(context->spec, options, "kind", "stale"),
        .moving = bb_spec_is(context->spec, options, "kind", "moving"),
        .chain = bb_spec_is(context->spec, options, "kind", "chain"),
        .nosy = bb_spec_is(context->spec, options, "kind", "nosy"),
        .early = bb_spec_is(context->spec, options, "kind", "early"),
        .marked = bb_spec_is(context->spec, options, "kind", "marked"),
        .lopsided = bb_spec_is(context->spec, options, "kind", "form") &&
                    context->device->form == BB_FORM_GPU,
        .follows = bb_spec_is(context->spec, options, "kind", "follows"),
        .still = bb_spec_is(context->spec, options, "kind", "still"),
        .forgets = bb_spec_is(context->spec, options, "kind", "forgets"),
        .frozen = bb_spec_is(context->spec, options, "kind", "frozen"),
        .hangs = bb_spec_is(context->spec, options, "kind", "hangs"),
        .term = bb_spec_value(context->spec, options, "term"),
        .at = bb_spec_value(context->spec, options, "at"),
        .sees_views = bb_spec_value(context->spec, NULL, "view") != NULL,
    };
    *out = self;
    meddle(self, "create");
    return BB_OK;
}

static void destroy(void *opaque)
{
    rogue *self = opaque;
    if (self != NULL)
        meddle(self, "destroy");
    if (self != NULL)
        bb_host_free(self->kept);
    bb_host_free(self);
}

/* All but the primitives' boxes, which are declared, must look as if it was not there. */
static bb_status look_around(const rogue *self, const bb_scene *scene)
{
    static const bb_box no_bounds;
    static const bb_profile no_profile;
    const bb_scene_device *there = &scene->on_device;
    if (!self->nosy)
        return BB_OK;
    if (scene->boxes == NULL || there->boxes.mem == NULL)
        return bb_fail(BB_FAILED, "rogue: the boxes are not there");
    if (scene->vertices != NULL || bb_scene_indices(scene) != NULL ||
        bb_scene_floats(scene, BB_SPHERE) != NULL)
        return bb_fail(BB_FAILED, "rogue: sees geometry on the host");
    if (there->vertices.mem != NULL || there->prims.mem != NULL)
        return bb_fail(BB_FAILED, "rogue: sees geometry on the device");
    if (memcmp(&scene->bounds, &no_bounds, sizeof no_bounds) != 0 ||
        memcmp(&scene->profile, &no_profile, sizeof no_profile) != 0)
        return bb_fail(BB_FAILED, "rogue: sees bounds or profile");
    if ((scene->view_count > 0) != self->sees_views)
        return bb_fail(BB_FAILED, "rogue: sees %u views", scene->view_count);
    return BB_OK;
}

static bb_status prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    (void)tree;
    rogue *self = opaque;
    while (self->hangs)
        pause();
    if (self->early)
        usleep(WORK_US);
    meddle(self, "prepare");
    if (self->frozen) {
        size_t bytes = scene->prim_count * sizeof *self->kept;
        BB_TRY(bb_host_alloc(NULL, bytes, "rogue: boxes", &self->kept));
        memcpy(self->kept, scene->boxes, bytes);
    }
    return look_around(self, scene);
}

static bb_status restore(void *opaque, const bb_scene *scene)
{
    rogue *self = opaque;
    meddle(self, "restore");
    if (self->early)
        usleep(WORK_US);
    return look_around(self, scene);
}

typedef struct range {
    uint32_t begin, end, node, skip, depth;
} range;

static void enclose(const bb_scene *scene, const range *r, bb_node *node)
{
    memcpy(node->lo, scene->boxes[r->begin].lo, sizeof node->lo);
    memcpy(node->hi, scene->boxes[r->begin].hi, sizeof node->hi);
    for (uint32_t i = r->begin + 1; i < r->end; i++)
        for (int axis = 0; axis < 3; axis++) {
            const bb_box *box = &scene->boxes[i];
            node->lo[axis] = box->lo[axis] < node->lo[axis] ? box->lo[axis] : node->lo[axis];
            node->hi[axis] = box->hi[axis] > node->hi[axis] ? box->hi[axis] : node->hi[axis];
        }
}

static uint32_t split(const rogue *self, const range *r)
{
    uint32_t count = r->end - r->begin;
    if (self->chain)
        return r->begin + 1;
    bool third = self->lopsided || (self->moving && self->builds > 0);
    return third ? r->end - 1 - (count - 1) / 3 : r->begin + count / 2;
}

static void build_nodes(const rogue *self, const bb_scene *scene, bb_tree *tree)
{
    range stack[STACK_MAX] = {{0, scene->prim_count, 0, BB_NONE, 0}};
    for (uint32_t top = 1; top > 0;) {
        range r = stack[--top];
        bb_node *node = &tree->nodes[r.node];
        enclose(scene, &r, node);
        node->skip = r.skip;
        if (r.end - r.begin == 1) {
            node->first = BB_LEAF_BIT | r.begin;
            tree->refs[r.begin] = r.begin | BB_LAST_BIT;
            tree->info.depth = r.depth > tree->info.depth ? r.depth : tree->info.depth;
            continue;
        }
        uint32_t middle = split(self, &r);
        uint32_t left = r.node + 1, right = r.node + 2 * (middle - r.begin);
        node->first = left;
        stack[top++] = (range){middle, r.end, right, r.skip, r.depth + 1};
        stack[top++] = (range){r.begin, middle, left, right, r.depth + 1};
    }
}

static bb_status add_marks(const rogue *self, bb_tree *tree)
{
    bb_tree_array *array;
    BB_TRY(bb_tree_reserve_array(tree, self->device, "marks", false, sizeof(uint32_t), &array));
    for (uint32_t i = 0; i < tree->info.node_count; i++)
        ((uint32_t *)array->host)[i] = i + self->builds;
    return BB_OK;
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)input;
    rogue *self = opaque;
    uint32_t count = scene->prim_count;
    BB_TRY(look_around(self, scene));
    if (self->early) {
        BB_TRY(bb_phase_outside(phases, "head start"));
        usleep(WORK_US);
    }
    BB_TRY(bb_phase(phases, "split"));
    if (!self->stale || self->builds == 0) {
        BB_TRY(bb_tree_reserve(tree, self->device, BB_ON_HOST, 2 * (size_t)count - 1, count));
        tree->info = (bb_tree_info){.node_count = 2 * count - 1,
                                    .leaf_count = count,
                                    .ref_count = count,
                                    .arity = count > 1 ? 2 : 0};
        bb_scene part = *scene;
        part.boxes = self->frozen ? self->kept : scene->boxes;
        build_nodes(self, &part, tree);
    }
    if (self->marked)
        BB_TRY(add_marks(self, tree));
    self->builds++;
    meddle(self, "build");
    return bb_phase(phases, NULL);
}

static bb_status describe(void *opaque, const bb_scene *scene, char *text, size_t capacity)
{
    (void)scene;
    if (capacity > 0)
        text[0] = '\0';
    meddle(opaque, "describe");
    return BB_OK;
}

static void decide(void *opaque, const bb_scene *scene, bb_decisions *decisions)
{
    (void)scene, (void)decisions;
    meddle(opaque, "decide");
}

static bb_status update(void *opaque, const bb_scene *scene, uint32_t changed, bb_tree *tree,
                        bb_phases *phases)
{
    rogue *self = opaque;
    uint32_t *order = NULL;
    if (!self->follows && !self->still && !self->forgets)
        return bb_fail(BB_UNSUPPORTED, "rogue: builds again");
    if (changed != BB_CHANGED_POSITIONS)
        return bb_fail(BB_FAILED, "rogue: it is said that %x changed", changed);
    BB_TRY(look_around(self, scene));
    BB_TRY(bb_phase(phases, "refit"));
    if (self->still)
        return bb_phase(phases, NULL);
    bb_node forgotten = tree->nodes[tree->nodes[0].first];
    BB_TRY(bb_host_alloc(NULL, tree->info.node_count * sizeof *order, "rogue: order", &order));
    bb_status status = bb_refit(tree, scene->boxes, scene->prim_count, order);
    bb_host_free(order);
    if (self->forgets)
        tree->nodes[tree->nodes[0].first] = forgotten;
    BB_TRY(status);
    return bb_phase(phases, NULL);
}

const bb_builder bb_builder_rogue = {
    .abi_version = BB_ABI_VERSION,
    .name = "rogue",
    .summary = "breaks a rule of builders, as told; for tests",
    .paper = "none",
    .kinds = BB_TRIANGLES,
    .inputs = BB_INPUT_BOXES,
    .place = BB_ON_HOST,
    .deterministic = true,
    .options = options,
    .create = create,
    .prepare = prepare,
    .build = build,
    .update = update,
    .restore = restore,
    .describe = describe,
    .decide = decide,
    .destroy = destroy,
};
