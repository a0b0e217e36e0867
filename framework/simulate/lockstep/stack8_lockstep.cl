/* stack_wide.cl, nodes of 8 children by distance, in lockstep: lockstep.clh. */
#include "kernel.clh"
#include "lockstep.clh"
#include "lockstep_stack.clh"
#include "lockstep_leaf.clh"
#include "stack8_visit.clh"
#include "lockstep_kernel.clh"
