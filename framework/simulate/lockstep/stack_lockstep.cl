/* stack.cl in lockstep: lockstep.clh. */
#include "kernel.clh"
#include "lockstep.clh"
#include "lockstep_stack.clh"
#include "lockstep_leaf.clh"
#include "stack_visit.clh"
#include "lockstep_kernel.clh"
