/* Early split clipping, on the host. */
#ifndef BB_PRESPLIT_ESC_H
#define BB_PRESPLIT_ESC_H

#include "framework/builder/builder.h"

/* As options of `presplit` say. */
typedef struct ps_esc_limits {
    double budget, above, saves;
} ps_esc_limits;

typedef struct ps_esc ps_esc;

bb_status ps_esc_create(bb_account *account, ps_esc_limits limits, ps_esc **out);
void ps_esc_destroy(ps_esc *self); /* NULL is allowed */

/* Reserves what splits of the scene take, but for the references. */
bb_status ps_esc_prepare(ps_esc *self, const bb_scene *scene);

/* Fills `references`, on the host. `scene` has boxes and geometry there. */
bb_status ps_esc_split(ps_esc *self, const bb_scene *scene, bb_references *references,
                       bb_phases *phases);

#endif
