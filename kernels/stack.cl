/* Stack traversal of pair nodes, while-while.
 *
 *   link = root
 *   loop: while link is a pair node:
 *             test both boxes
 *             go to the nearer, push the farther with its distance
 *         test the primitives of the leaf
 *         pop until an entry is nearer than the hit
 *
 * Aila and Laine 2009, "Understanding the Efficiency of Ray Traversal on GPUs": the per-ray
 * while-while loop, without speculation. Pro: few steps, children in order. Con: a stack per ray of
 * BB_STACK_SIZE entries. The host sizes it by the tree's need, up to a limit; an overflow leaves
 * the hit poisoned, so that it cannot pass for an answer.
 *
 *   BB_STACK_SIZE   entries
 *   and those of trace.clh
 */
#include "stack_pair.clh"

#define BB_TRACE_NODE float
#include "trace.clh"
