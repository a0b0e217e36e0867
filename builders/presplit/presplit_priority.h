/* Splits by priority on the device (presplit.cl). */
#ifndef BB_PRESPLIT_PRIORITY_H
#define BB_PRESPLIT_PRIORITY_H

#include "framework/builder/builder.h"

typedef struct ps_priority ps_priority;

/* beta: most splits per primitive of the scene, 0 to 15. saves: share of the box's area that a
 * triangle's first split must save, -1 to 0.9. The caller owns *out, also on failure if it is not
 * NULL. */
bb_status ps_priority_create(const bb_builder_context *context, double beta, double saves,
                             ps_priority **out);
void ps_priority_destroy(ps_priority *self); /* NULL is allowed */

/* Reserves scratch for splits of the scene, without the references. */
bb_status ps_priority_prepare(ps_priority *self, const bb_scene *scene);

/* Fills `references` on the device. Reads boxes and geometry there. */
bb_status ps_priority_split(ps_priority *self, const bb_scene *scene, bb_references *references,
                            bb_phases *phases);

#endif
