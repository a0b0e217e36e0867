/* Early split clipping on the host. */
#ifndef BB_PRESPLIT_ESC_H
#define BB_PRESPLIT_ESC_H

#include "framework/builder/builder.h"

/* Limits, as in the options of `presplit`. */
typedef struct ps_esc_limits {
    double budget; /* most references, per primitive */
    double above;  /* area of the smallest box to split, relative to the mean area */
    double saves;  /* least area that a split must save, as a share of the box's area */
} ps_esc_limits;

typedef struct ps_esc ps_esc;

/* `account` must outlive the object. BB_REFUSED if there is no memory; *out is then unchanged. */
bb_status ps_esc_create(bb_account *account, ps_esc_limits limits, ps_esc **out);
void ps_esc_destroy(ps_esc *self); /* NULL is allowed */

/* Reserves scratch for splits of the scene, without the references: 16 bytes for each of the most
 * references that there may be. It is kept for smaller scenes. */
bb_status ps_esc_prepare(ps_esc *self, const bb_scene *scene);

/* Fills `references` on the host, where `scene` has boxes and geometry. Prepares for the scene if
 * that was not done. Phases "areas" and "split". */
bb_status ps_esc_split(ps_esc *self, const bb_scene *scene, bb_references *references,
                       bb_phases *phases);

#endif
