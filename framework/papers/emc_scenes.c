/* Which of our scenes stands in for which of Vinkler, Bittner, Havran 2017. */
#include "framework/papers/emc.h"

#include <string.h>

/* By a scene's name without parameters, or its file's without folder and ending. The paper's are
 * not shipped, and the text that was at hand says little of their shapes: its table 1, the
 * properties of the scenes, is illegible. */
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
    {NULL, "unknown", ""},
};

static size_t find_stand_in(const char *scene)
{
    const char *slash = strrchr(scene, '/');
    const char *name = slash != NULL ? slash + 1 : scene;
    const size_t length = strcspn(name, ":.");
    size_t i = 0;
    while (stand_ins[i].name != NULL &&
           (strlen(stand_ins[i].name) != length || strncmp(stand_ins[i].name, name, length) != 0))
        i++;
    return i;
}

static void say_theirs(bb_paper_place at, const bb_figure *figure, bb_words *words)
{
    (void)figure;
    bb_say(words, "%s", stand_ins[find_stand_in(at.scene)].theirs);
}

static void say_alike(bb_paper_place at, const bb_figure *figure, bb_words *words)
{
    (void)figure;
    bb_say(words, "%s", stand_ins[find_stand_in(at.scene)].alike);
}

const bb_paper_column bb_emc_scenes[] = {
    BB_COLUMN_OF("scene", BB_SHOW_SCENE),
    {.heading = "primitives", .figure = &(const bb_figure){.what = "prims"}},
    BB_COLUMN("flatness", &bb_emc_flatness, 3),
    {.heading = "largest / median", .figure = &bb_emc_spread, .decimals = 1},
    {.heading = "stands in for", .shown = BB_SHOW_WORDS, .words = say_theirs},
    {.heading = "alike in", .shown = BB_SHOW_WORDS, .words = say_alike},
    {.heading = NULL},
};
