/* Which of our scenes stands in for which of the paper's, and how alike they are. The paper's are
 * not shipped, and the text that was at hand says little of their shapes: its table 1, the
 * properties of the scenes, is illegible.
 */
#include "framework/papers/emc_methods.h"

#include <string.h>

/* By a scene's name without parameters, or its file's without folder and ending. */
static const struct {
    const char *name, *theirs, *alike;
} stand_ins[] = {
    /* The first 12 splits of Pompeii's code are along x and z (section 5.1). The longer of them, of
     * length L, gets k >= 6 of these, the last one while its cells, L / 2^(k - 1) long, are no
     * shorter than y. So y <= L / 32. */
    {"city", "pompeii, city",
     "flat (pompeii: height at most 1/32 of its length, derived from section 5.1), large ground"},
    {"interior", "conference, sodahall", "a closed room, few huge triangles beside small ones"},
    {"kitchen", "conference, sponza", "a furnished room, modelled by hand"},
    {"bathroom2", "conference, sponza", "a furnished room, modelled by hand"},
    {"hairball", "hairball", "thin triangles of one length in all directions"},
    {"terrain", "none", "flat like pompeii and city, but with triangles of one size"},
    {"mountain", "none", "a scanned height field, finely tessellated"},
    {"coffee", "none", "an object in fine triangles on a large ground"},
    {"scorpion", "none", "an object; theirs are buildings, but for hairball"},
};
enum { STAND_INS = sizeof stand_ins / sizeof stand_ins[0] };

/* Number of the scene's row; STAND_INS if it has none. */
static size_t find_stand_in(const char *scene)
{
    const char *slash = strrchr(scene, '/');
    const char *name = slash != NULL ? slash + 1 : scene;
    size_t length = strcspn(name, ":.");
    for (size_t i = 0; i < STAND_INS; i++)
        if (strlen(stand_ins[i].name) == length && strncmp(stand_ins[i].name, name, length) == 0)
            return i;
    return STAND_INS;
}

void bb_emc_scenes(const bb_findings *all, bb_reproduction *r)
{
    static const char *const columns[] = {
        "scene", "primitives", "flatness", "largest / median", "stands in for", "alike in", NULL};
    const bb_findings *f = &all[EMC_INSIDE];
    bb_paper_table(
        r,
        "Scenes of the tables that follow, and the paper's for which they stand. Nothing here "
        "is like san-miguel or powerplant, nor as large; flatness: shortest over longest side",
        columns);
    for (size_t s = 0; s < f->scene_count; s++) {
        const char *scene = f->scenes[s];
        size_t row = find_stand_in(scene);
        bb_paper_row(r);
        bb_paper_text(r, scene);
        bb_paper_number(r, bb_found_scene(f, scene, BB_F_SCENE_PRIMS), 0);
        bb_paper_number(r, bb_found_scene(f, scene, BB_F_PROFILE_FLATNESS), 3);
        bb_paper_number(r,
                        bb_found_scene(f, scene, BB_F_PROFILE_SIZE_MAX) /
                            bb_found_scene(f, scene, BB_F_PROFILE_SIZE_MEDIAN),
                        1);
        bb_paper_text(r, row < STAND_INS ? stand_ins[row].theirs : "unknown");
        bb_paper_text(r, row < STAND_INS ? stand_ins[row].alike : "");
    }
}
