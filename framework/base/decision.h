/* A decision on a scene or a tree, who made it, and the figure it rests on. Builders and kernels
 * report their decisions, records keep them, and `advise` and the report show them. */
#ifndef BB_DECISION_H
#define BB_DECISION_H

#include <stddef.h>
#include <stdint.h>

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

/* Who decided: the default, which looks at nothing; the scene's profile; the finished tree; the
 * user, by a parameter, which overrides the others; or the device, which forced a smaller value. */
typedef enum bb_decider {
    BB_BY_DEFAULT,
    BB_BY_SCENE,
    BB_BY_TREE,
    BB_GIVEN,
    BB_BY_DEVICE,
} bb_decider;

/* Names of decisions that mean the same in every plug-in. */
#define BB_DECIDED_CODE_BITS "code bits"
#define BB_DECIDED_SIZE_BITS "size bits"
#define BB_DECIDED_LEVELS "octree levels"
#define BB_DECIDED_STACK "stack entries"
#define BB_DECIDED_KINDS "kinds compiled in"

enum { BB_DECISIONS_MAX = 8 }; /* per builder, kernel or scene */

typedef struct bb_decision {
    const char *what; /* a constant, such as the names above */
    char value[48];   /* a number in plain digits, or a word */
    bb_decider by;
    char figure[128]; /* what the decision rests on; if `given`, what it would have rested on */
} bb_decision;

/* Decisions in order. A zeroed list is empty. */
typedef struct bb_decisions {
    uint32_t count;
    bb_decision items[BB_DECISIONS_MAX];
} bb_decisions;

/* Returns the word in records: "default", "scene", "tree", "given", "device". */
const char *bb_decider_word(bb_decider by);

/* Append a decision: a number or a word, and its figure, formatted like printf(). A full list stays
 * unchanged. */
void bb_decide_number(bb_decisions *list, const char *what, uint64_t value, bb_decider by,
                      const char *figure, ...) __attribute__((format(printf, 5, 6)));
void bb_decide_word(bb_decisions *list, const char *what, const char *value, bb_decider by,
                    const char *figure, ...) __attribute__((format(printf, 5, 6)));

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
