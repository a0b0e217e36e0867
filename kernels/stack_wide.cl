/* Stack traversal of wide nodes: tests all children's boxes at once, and primitives in blocks of
 * BB_LANES.
 *
 *   link = root
 *   loop: while link is a node:
 *             test its boxes
 *             none met: pop
 *             else: go to the nearest, push the others, the farthest first
 *         test the blocks of the leaf
 *         pop until an entry is nearer than the hit
 *
 * Wald, Benthin, Boulos 2008, "Getting Rid of Packets: Efficient SIMD Single-Ray Traversal using
 * Multi-Branching BVHs"; Dammertz, Hanika, Keller 2008, "Shallow Bounding Volume Hierarchies for
 * Fast SIMD Ray Tracing of Incoherent Rays". Pro: one ray keeps the vector units busy, so rays need
 * not be coherent. Con: on devices that run work-items in lockstep the vectors are unrolled.
 * Overflow and equal distances as in stack.cl.
 *
 *   BB_WIDTH, BB_QUANTISED  the node: wide.clh
 *   BB_ORDER        sorted: children by distance; octant: by their places, which the layout assigns
 *                   for this: saves the sorting but is only roughly right (nodes of 8)
 *   BB_STACK_SIZE   entries
 *   and those of trace.clh
 */
#include "stack_wide.clh"

#define BB_TRACE_NODE bb_wide
#include "trace.clh"
