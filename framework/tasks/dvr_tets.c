/* Pictures of tetrahedra, by trees that say which of them holds a sample. */
#include "framework/tasks/dvr_private.h"

static bb_status set(bb_dvr *dvr, const bb_march_settings *settings)
{
    return bb_tet_marcher_set(dvr->tet_marcher, settings, dvr->request->transfer);
}

static bb_status ask(void *self, const bb_contest_runner *runner, bb_contest_answers answers)
{
    const bb_dvr *dvr = self;
    bb_tet_search search;
    BB_TRY(bb_contest_search(runner, &dvr->task, 0, &search));
    search.recording = answers.recording;
    return bb_tet_march(dvr->tet_marcher, &search, runner->by_boundary, &dvr->rays.on_device,
                        dvr->pixels, answers.items, answers.counts);
}

static bb_status code_of(void *self, const bb_contest_runner *runner, bb_simulated_code *code)
{
    const bb_dvr *dvr = self;
    bb_tet_search search;
    BB_TRY(bb_contest_search(runner, &dvr->task, 0, &search));
    BB_TRY(bb_tet_search_code(&search, "tet_march", runner->by_boundary, code));
    code->footing.item_bytes = sizeof(bb_ray);
    code->footing.result_bytes = sizeof(bb_light);
    code->footing.entry_bytes = sizeof(bb_transfer_entry);
    code->footing.in_region = runner->by_boundary; /* where the ray may be inside */
    return BB_OK;
}

bb_status bb_dvr_of_tets(bb_dvr *dvr)
{
    dvr->unit = bb_tet_march_width(dvr->scene);
    dvr->set = set;
    dvr->task.ask = ask;
    dvr->task.code = code_of;
    return bb_tet_marcher_create(dvr->scene, NULL, &dvr->tet_marcher);
}
