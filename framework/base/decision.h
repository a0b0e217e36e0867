/* What was decided for a scene or a tree, by whom, and the figure that it rests on. Builders and
 * kernels report theirs; records keep them, `advise` and the report show them. */
#ifndef BB_DECISION_H
#define BB_DECISION_H

#include <stddef.h>
#include <stdint.h>

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

/* What decided: the default, which asks nobody; the scene's profile; the tree as it was built; a
 * parameter given by hand, which wins over all of these; or the device, for which it was less. */
typedef enum bb_decider {
    BB_BY_DEFAULT,
    BB_BY_SCENE,
    BB_BY_TREE,
    BB_GIVEN,
    BB_BY_DEVICE,
} bb_decider;

/* Names of decisions that have the same meaning whoever makes them. */
#define BB_DECIDED_CODE_BITS "code bits"
#define BB_DECIDED_SIZE_BITS "size bits"
#define BB_DECIDED_LEVELS "octree levels"
#define BB_DECIDED_STACK "stack entries"
#define BB_DECIDED_KINDS "kinds compiled in"

enum { BB_DECISIONS_MAX = 8 }; /* of one builder, kernel or scene */

typedef struct bb_decision {
    const char *what; /* a constant, such as those above */
    char value[48];   /* a number in plain digits, or a word */
    bb_decider by;
    char figure[128]; /* what it rests on; given: what there would have been to rest on */
} bb_decision;

/* Several, in order. A zeroed list is empty. */
typedef struct bb_decisions {
    uint32_t count;
    bb_decision items[BB_DECISIONS_MAX];
} bb_decisions;

/* As records have it: "default", "scene", "tree", "given", "device". */
const char *bb_decider_word(bb_decider by);

/* Appends a number, or a word, with its figure as printf() does. A list that is full stays as it
 * is. */
void bb_decide_number(bb_decisions *list, const char *what, uint64_t value, bb_decider by,
                      const char *figure, ...) __attribute__((format(printf, 5, 6)));
void bb_decide_word(bb_decisions *list, const char *what, const char *value, bb_decider by,
                    const char *figure, ...) __attribute__((format(printf, 5, 6)));

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
