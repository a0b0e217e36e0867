/* packet.cl in lockstep, pair nodes: lockstep_packet.clh. */
#include "kernel.clh"
#include "lockstep.clh"
#define PLACE(entry) ((entry) + 2048u) /* of a ray's own stack */
#include "lockstep_stack.clh"
#include "lockstep_leaf.clh"
#include "stack_visit.clh"
#include "lockstep_packet.clh"
