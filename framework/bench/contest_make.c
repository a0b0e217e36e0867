/* Trees, layouts and programs of all ways. */
#include "framework/bench/contest_private.h"

#include "framework/base/memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What a builder or a search can't do is the way's, all else ends the contest. */
static bb_status note(bb_contest_way *way, bb_status status)
{
    if (status != BB_UNSUPPORTED && status != BB_REFUSED)
        return status;
    snprintf(way->refused, sizeof way->refused, "%s", bb_message());
    return BB_OK;
}

/* What precedes the specification of a builder over faces. */
static const char of_faces[] = "faces/";

static bool is_of_faces(const char *builder)
{
    return strncmp(builder, of_faces, sizeof of_faces - 1) == 0;
}

uint32_t bb_contest_count_ways(const bb_contest_request *request)
{
    uint32_t count = request->without ? 1 : 0;
    for (uint32_t i = 0; i < request->builder_count; i++)
        count += is_of_faces(request->builders[i]) ? request->kernel_count : request->search_count;
    return count;
}

static bb_status parse_choice(bb_contest *c, const char *text, bool tets,
                              bb_contest_search_choice *out)
{
    uint64_t leaf = 1;
    if (tets)
        BB_TRY(bb_tet_search_parse(text, &out->spec));
    else {
        BB_TRY(bb_kernel_parse(text, &out->spec, &out->kernel));
        BB_TRY(bb_spec_u64(&out->spec, bb_kernel_common_options, "leaf", 1, BB_LEAF_MAX, &leaf));
    }
    const bb_layout *layout = bb_layout_find(tets ? out->spec.name : out->kernel->layout);
    bb_layout_wish wish = tets ? (bb_layout_wish){0} : bb_kernel_wish(&out->spec);
    BB_TRY(bb_residency_layout(&c->residency, layout, &wish, (uint32_t)leaf, BB_FORMAT_VERTICES,
                               &out->layout));
    wish.preorder = layout->array.name == NULL; /* arrays rely on the tree's own numbers */
    return c->request->simt_count == 0
               ? BB_OK
               : bb_residency_layout(&c->residency, layout, &wish, (uint32_t)leaf,
                                     BB_FORMAT_VERTICES, &out->simulated);
}

bb_status bb_contest_search(const bb_contest_runner *r, const bb_contest_task *task,
                            uint32_t number, bb_tet_search *search)
{
    const bb_scene *scene = task->scenes[number];
    if (!r->without)
        return bb_tet_search_by(scene, r->layout, r->data[number], search);
    bb_tet_search_all(scene, &r->lists[number], search);
    return BB_OK;
}

void bb_contest_pin(bb_contest *c, const bb_contest_entrant *e)
{
    bb_residency_pin(&c->residency, e->trees, e->tree_count);
}

bb_status bb_contest_bring(bb_contest *c, const bb_contest_entrant *e, uint32_t layout)
{
    bb_contest_pin(c, e);
    for (uint32_t s = 0; s < e->tree_count; s++)
        BB_TRY(bb_resident_tree(&c->residency, &e->trees[s]));
    for (uint32_t s = 0; s < e->tree_count; s++)
        BB_TRY(bb_resident_layout(&c->residency, &e->trees[s], layout));
    return BB_OK;
}

static bb_status make_runner(bb_contest *c, const bb_contest_entrant *e, bb_contest_runner *r,
                             const bb_contest_search_choice *how)
{
    bb_contest_way *way = r->way;
    r->layout = c->residency.layouts[how->layout].layout;
    for (uint32_t s = 0; s < e->tree_count; s++)
        r->data[s] = &e->trees[s].layouts[how->layout];
    BB_TRY(bb_contest_bring(c, e, how->layout));
    r->kernel = how->kernel;
    r->spec = &how->spec;
    if (how->kernel != NULL)
        BB_TRY(c->task->compile(c->task->self, r));
    else
        r->by_boundary = bb_tet_search_by_boundary(&how->spec);
    for (uint32_t s = 0; s < e->tree_count; s++) {
        const bb_instance *instance = &e->trees[s].instance;
        way->nodes += instance->tree.info.node_count;
        way->leaves += instance->tree.info.leaf_count;
        way->references += instance->tree.info.ref_count;
        way->query_bytes += r->data[s]->bytes;
        way->bytes += instance->account.peak + r->data[s]->bytes;
        way->tree_bytes += bb_tree_bytes(&instance->tree);
    }
    way->query_bytes += e->trees[0].scene == c->task->faces ? c->task->face_bytes : 0;
    return BB_OK;
}

static bb_status make_tree(bb_contest *c, bb_resident *tree)
{
    bb_pipeline pipeline;
    BB_TRY(bb_pipeline_parse(tree->text, &pipeline));
    const bool votes = (pipeline.stages[0].builder->inputs & BB_INPUT_VOLUME) != 0;
    if (c->task->blank && (pipeline.count > 1 || !votes))
        return bb_fail(BB_UNSUPPORTED, "there is nothing to build over");
    BB_TRY(bb_resident_tree(&c->residency, tree));
    return c->task->blank ? BB_OK : bb_resident_check(tree);
}

/* `first`: the entrant's first way. */
static bb_status make_entrant(bb_contest *c, uint32_t i, uint32_t first)
{
    const bb_contest_request *request = c->request;
    const char *builder = request->builders[i];
    const bool faces = is_of_faces(builder);
    bb_contest_entrant *e = &c->entrants[i];
    bb_status status = BB_OK;
    *e =
        (bb_contest_entrant){.trees = &c->residency.items[i * c->task->scene_count],
                             .tree_count = faces ? 1 : c->task->scene_count,
                             .runners = &c->runners[first],
                             .choices = c->choices + (faces ? request->search_count : 0),
                             .choice_count = faces ? request->kernel_count : request->search_count};
    bb_contest_pin(c, e);
    for (uint32_t s = 0; s < e->tree_count && status == BB_OK; s++) {
        e->trees[s].text = builder + (faces ? sizeof of_faces - 1 : 0);
        e->trees[s].scene = faces ? c->task->faces : c->task->scenes[s];
        status = make_tree(c, &e->trees[s]);
    }
    for (uint32_t k = 0; k < e->choice_count; k++) {
        bb_contest_runner *runner = &e->runners[k];
        runner->entrant = i;
        runner->choice = k;
        runner->way->builder = builder;
        runner->way->search = faces ? request->kernels[k] : request->searches[k];
        if (status != BB_OK)
            BB_TRY(note(runner->way, status));
        else if (!c->task->blank)
            BB_TRY(note(runner->way, make_runner(c, e, runner, &e->choices[k])));
    }
    return BB_OK;
}

static bb_status parse_choices(bb_contest *c)
{
    const bb_contest_request *request = c->request;
    const bool tets = c->task->compile == NULL || c->task->faces != NULL;
    for (uint32_t k = 0; k < request->search_count; k++)
        BB_TRY(parse_choice(c, request->searches[k], tets, &c->choices[k]));
    for (uint32_t k = 0; k < request->kernel_count; k++)
        BB_TRY(parse_choice(c, request->kernels[k], false, &c->choices[request->search_count + k]));
    return BB_OK;
}

static bb_status reserve(bb_contest *c)
{
    const bb_contest_request *request = c->request;
    const uint32_t most = c->task->most_items;
    const size_t bytes = most * c->task->answer_bytes;
    BB_TRY(bb_host_alloc(NULL, bytes, "answers", &c->with));
    BB_TRY(bb_host_alloc(NULL, bytes, "answers", &c->without));
    BB_TRY(bb_host_alloc(NULL, most * sizeof *c->counts, "counts", &c->counts));
    BB_TRY(bb_buffer_reserve(request->device, NULL, bytes, "answers", &c->d_answers));
    BB_TRY(
        bb_buffer_reserve(request->device, NULL, most * sizeof *c->counts, "counts", &c->d_counts));
    c->residency = (bb_residency){.device = request->device,
                                  .seed = request->seed,
                                  .count = request->builder_count * c->task->scene_count};
    c->residency.items = calloc(c->residency.count, sizeof *c->residency.items);
    c->entrants = calloc(request->builder_count, sizeof *c->entrants);
    c->choices = calloc(request->search_count + request->kernel_count, sizeof *c->choices);
    if (c->residency.items == NULL || c->entrants == NULL || c->choices == NULL)
        return bb_fail(BB_REFUSED, "no memory for a comparison");
    BB_TRY(parse_choices(c));
    for (uint32_t w = 0; w < c->way_count; w++) {
        c->ways[w].builder = c->ways[w].search = "";
        c->ways[w].light = c->task->light;
        c->runners[w].way = &c->ways[w];
    }
    c->runners[0].without = request->without;
    for (uint32_t s = 0; s < c->task->scene_count && request->without; s++)
        if (c->task->scenes[s]->tets != NULL)
            BB_TRY(bb_tet_list_make(c->task->scenes[s], &c->runners[0].lists[s]));
    return BB_OK;
}

/* The first way that is not refused. */
static bb_status choose_base(bb_contest *c)
{
    while (c->base + 1 < c->way_count && c->ways[c->base].refused[0] != '\0')
        c->base++;
    return c->ways[c->base].refused[0] == '\0'
               ? BB_OK
               : bb_fail(BB_UNSUPPORTED, "%s by %s, and no other way either: %s",
                         c->ways[0].builder, c->ways[0].search, c->ways[0].refused);
}

void bb_contest_clean_up(bb_contest *c)
{
    for (uint32_t i = 0; c->residency.items != NULL && i < c->residency.count; i++)
        bb_resident_evict(&c->residency.items[i]);
    bb_residency_end(&c->residency);
    for (uint32_t s = 0; s < BB_CONTEST_SCENES_MAX; s++)
        bb_buffer_release(&c->runners[0].lists[s]);
    free(c->residency.items);
    free(c->entrants);
    free(c->choices);
    bb_host_free(c->with);
    bb_host_free(c->without);
    bb_host_free(c->counts);
    bb_buffer_release(&c->d_answers);
    bb_buffer_release(&c->d_counts);
    free(c);
}

bb_status bb_contest_make(bb_contest *c)
{
    uint32_t first = c->first;
    BB_TRY(reserve(c));
    for (uint32_t i = 0; i < c->request->builder_count; i++) {
        BB_TRY(make_entrant(c, i, first));
        first += c->entrants[i].choice_count;
    }
    return choose_base(c);
}
