/* A tracer on a scene: its object, the clock of its builds and traces, the threads that call it. */
#ifndef BB_TRACING_H
#define BB_TRACING_H

#include "framework/builder/guard.h"
#include "framework/builder/instance.h"
#include "framework/builder/tracers.h"

typedef struct bb_tracing bb_tracing;

/* Creates the tracer's object for the row `text`. BB_UNSUPPORTED: it does not take the scene's
 * primitives, or lacks what its parameters ask for. To be freed by bb_tracing_destroy(), before the
 * scene. */
bb_status bb_tracing_create(bb_device *device, const char *text, const bb_scene *scene,
                            bb_tracing **out);
void bb_tracing_destroy(bb_tracing *tracing); /* NULL is allowed */

/* Builds anew, and traces a few rays within the clock, which must be answered alike later.
 * BB_FAILED also if, three times in a row, it seems to go on building when more rays come.
 * `phases` gets the tracer's; the time by the device's clock is their sum and that of the rays. */
bb_status bb_tracing_build(bb_tracing *tracing, bb_build_timing *timing, bb_phases *phases);

/* The same on the scene in disguise, mirrored along these axes (framework/scene/disguise.h). The
 * next build, of the scene itself, fails unless it answers mirrored rays as this one has answered
 * rays. */
bb_status bb_tracing_build_disguised(bb_tracing *tracing, uint32_t mirrored,
                                     bb_build_timing *timing);

/* Rays are passed as `spec` says from now on, not timed: whether the tracer can. If it dies,
 * `whose` row is lost. */
bb_status bb_tracing_pass(bb_tracing *tracing, bb_guarded whose, const bb_spec *spec);

/* Traces on all threads; `pass` says how rays are passed, within the clock (NULL: as before). If
 * the tracer dies, `whose` row is lost. The time by the device's clock is that of the threads, from
 * the first that began to the last that ended. BB_FAILED also if answers are written after it. */
bb_status bb_tracing_trace(bb_tracing *tracing, bb_guarded whose, const bb_spec *pass,
                           const bb_ray *rays, uint32_t count, bool any, bb_hit *hits,
                           bb_timing *timing);

/* Returns what create() took. */
double bb_tracing_create_ms(const bb_tracing *tracing);

/* Returns the bytes that it holds since its last build: those that the tracer says, unless those
 * that its create() and build() have added to the heap are more by a tenth and 1 MiB, or those that
 * the process has more, but for free ones of the heap, by 32 MiB. */
uint64_t bb_tracing_bytes(const bb_tracing *tracing);

/* Describes the last build; "" if the tracer does not. */
bb_status bb_tracing_describe(bb_tracing *tracing, char *text, size_t capacity);

#endif
