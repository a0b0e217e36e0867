/* Pictures of volumes: the march along rays through a tree of the bricks that are seen, and without
 * one (kernels/march.clh).
 *
 * With a tree it is a query like any other: bb_march_tracer_request() and bb_march_pass() complete
 * what traversal/ needs for it.
 */
#ifndef BB_MARCH_H
#define BB_MARCH_H

#include "traversal/pass.h"

typedef struct bb_marcher bb_marcher;

/* How it is done. */
typedef struct bb_march_settings {
    float step;   /* distance of samples, in scene units; above 0 */
    float cutoff; /* it ends where less of the light behind is left, 0 to 1; 0: never */
} bb_march_settings;

/* Results are bb_light. It is not among the queries that `judge` knows: rays are not asked what
 * they hit. */
extern const bb_query bb_query_march;

/* For the scene's volume, which is on the device. Scratch is booked on `account`. Owned by the
 * caller. */
bb_status bb_marcher_create(const bb_scene *scene, bb_account *account, bb_marcher **out);
void bb_marcher_destroy(bb_marcher *marcher); /* NULL is allowed */

/* Takes settings and the volume's transfer function as it is now. */
bb_status bb_marcher_set(bb_marcher *marcher, const bb_march_settings *settings);

/* BB_INVALID for settings that no march has. */
bb_status bb_march_check_settings(const bb_march_settings *settings);

/* BB_REFUSED if a ray has more samples than a float counts. */
bb_status bb_march_check(const bb_scene *scene, const bb_rays *rays, float step);

/* Sets query and defines; they live as long as the marcher. */
void bb_march_tracer_request(const bb_marcher *marcher, bb_tracer_request *request);

/* Sets query, and the arguments besides. */
void bb_march_pass(const bb_marcher *marcher, bb_pass *pass);

/* Without a tree. Enqueues the rays; does not wait. `lights` (bb_light[count]); `counts`, if not
 * NULL, gets samples as primitives. */
bb_status bb_march_all(bb_marcher *marcher, const bb_buffer *rays, uint32_t count,
                       bb_buffer *lights, bb_buffer *counts);

#endif
