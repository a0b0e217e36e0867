/* Renders volumes by marching along rays (kernels/march.clh), with a tree of the visible bricks or
 * without a tree.
 *
 * With a tree the march is an ordinary query: bb_march_traverser_request() and bb_march_pass() fill
 * in the parts that traversal/ needs for it.
 */
#ifndef BB_MARCH_H
#define BB_MARCH_H

#include "traversal/pass.h"

enum { BB_MARCH_GROUP = 64 }; /* rays of a work-group, without a tree */

typedef struct bb_marcher bb_marcher;

typedef struct bb_march_settings {
    float step;   /* distance between samples in scene units, above 0 */
    float cutoff; /* a ray ends once its transmittance is below this, 0 to 1; 0: never */
} bb_march_settings;

/* Results are bb_light. The judge does not know this query, since its rays hit nothing. */
extern const bb_query bb_query_march;

/* Creates a marcher for the scene's volume, which must be on the device. Scratch is booked on
 * `account`. The caller owns the marcher. */
bb_status bb_marcher_create(const bb_scene *scene, bb_account *account, bb_marcher **out);
void bb_marcher_destroy(bb_marcher *marcher); /* NULL is allowed */

/* Copies the settings and the volume's current transfer function. */
bb_status bb_marcher_set(bb_marcher *marcher, const bb_march_settings *settings);

/* Returns BB_INVALID if a setting is out of range. */
bb_status bb_march_check_settings(const bb_march_settings *settings);

/* Returns BB_REFUSED if a ray has more samples than a float can count. */
bb_status bb_march_check(const bb_scene *scene, const bb_rays *rays, float step);

/* Sets query and defines, which live as long as the marcher. */
void bb_march_traverser_request(const bb_marcher *marcher, bb_traverser_request *request);

/* Sets the query and the march's own arguments. */
void bb_march_pass(const bb_marcher *marcher, bb_pass *pass);

/* Marches without a tree. Enqueues the rays and does not wait. `lights` gets bb_light[count];
 * `counts`, if not NULL, gets samples as primitives; `recording`, if not NULL, the steps: then
 * counts are asked for, too. */
bb_status bb_march_all(bb_marcher *marcher, const bb_buffer *rays, uint32_t count,
                       bb_buffer *lights, bb_buffer *counts, const bb_recording *recording);

#endif
