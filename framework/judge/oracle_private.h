/* State shared by the oracle and the judge. */
#ifndef BB_ORACLE_PRIVATE_H
#define BB_ORACLE_PRIVATE_H

#include "framework/base/threads.h"
#include "framework/judge/arbiter.h"
#include "framework/judge/clear_way.h"
#include "framework/judge/embree.h"
#include "framework/judge/oracle.h"

struct bb_oracle {
    const bb_scene *scene;
    uint32_t threads;
    bb_pool *pool;
    bb_embree *embree;  /* NULL after bb_oracle_give_up(), until it is asked for */
    bb_arbiter arbiter; /* these three are made when there is something to arbitrate */
    bb_way *way;
    float *heights; /* smallest height of each triangle, diameter of each sphere */
};

/* Frees answers->judged. */
void bb_judged_release(bb_answers *answers);

#endif
