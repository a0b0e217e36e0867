/* What the tables and the claims of the loose octrees share. */
#ifndef BB_LOOSE_OCTREE_H
#define BB_LOOSE_OCTREE_H

#include "framework/papers/reproduce.h"

#define STACK "stack"
#define STACKLESS "stackless"
/* As published: cells are cubes for all; primitives of one node of the loose octree share a leaf,
 * however many they are; LOBVH has four arrays for all nodes of the octree, keeps nodes with a
 * single child, and is ordered by the view that is traced, always. */
#define LBVH30 "lbvh:bits=30,box=cube"
#define LLBVH30 "llbvh:bits=30,merge=0,link=search"
#define LOBVH(levels) "lobvh:levels=" levels ",chains=keep,octree=arrays,view=0"
/* The same tree by bits instead of arrays, as deep as the scene asks for. */
#define LOBVH_AUTO "lobvh:levels=auto,chains=keep,view=0"
/* One thing otherwise: LLBVH linked in Apetrei's way, not in Karras' (algorithm 1); LBVH's rule of
 * leaves; leaves of about 64 primitives; chains skipped. */
#define LLBVH30_LINKED "llbvh:bits=30,merge=0"
#define LLBVH30_SINGLE "llbvh:bits=30,merge=1,link=search"
#define LLBVH30_64 "llbvh:bits=30,link=search"
#define LOBVH_SKIPPING "lobvh:levels=auto,view=0"
#define LOBVH_BEST LOBVH("{6,7,8}")
#define LOBVH_VIEWLESS "lobvh:levels=6,chains=keep,octree=arrays"
#define SMALLEST LLBVH30 ",side=smallest"

/* Experiments, in order. */
enum { OF_SPHERES, OF_TRIANGLES, OF_SIZES, OF_VIEWS };
enum { VIEWS = 3 };

#define FRAME "build_ms+trace_ms"
#define MIB (1.0 / (1 << 20))

/* LLBVH by the size that a box's level is taken from. */
enum { OTHER_SIDES = 7 << 1, EVEN = 1 << 5 };
extern const bb_paper_entrant bb_box_sizes[];

/* By the view that orders their children. */
enum { BINARY_BY_STACK = 1 << 0 | 1 << 2, LOBVH_STACKLESS = 1 << 5 };
extern const bb_paper_entrant bb_view_ordered[];
extern const bb_figure bb_order_factor;

extern const bb_paper_claim bb_loose_octree_claims[];

#endif
