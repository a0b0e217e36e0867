/* What the experiments of OLBVH's paper share: names, and what measures them. */
#ifndef BB_PAPER_OLBVH_H
#define BB_PAPER_OLBVH_H

#include "framework/papers/reproduce.h"

enum { BB_OLBVH_PICTURE = 1024, BB_OLBVH_SLICE = 999 }; /* sides: the paper's */

/* Experiments, in order. */
enum { BB_OLBVH_RENDERING, BB_OLBVH_SLICES, BB_OLBVH_OVERLAPS, BB_OLBVH_LOCATION, BB_OLBVH_TASKS };

#define LBVH "lbvh"
#define ALPHA0 "olbvh"
#define ALPHA1 "olbvh:alpha=1"
#define ALPHA2 "olbvh:alpha=2"
/* Of faces: the same builder, and one whose trees cost less, as OptiX' may. */
#define FACES_LBVH "faces/lbvh"
#define FACES_PLOC "faces/ploc"
#define FACES_EMBREE "faces/embree-native"

/* A bb_paper's measure(). */
bb_status bb_olbvh_measure(const bb_reproduce_request *request, bb_findings *findings, bool *wrong);

#endif
