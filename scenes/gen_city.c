/* A large flat city: streets and pavements of triangles as long as the city or a block, houses and
 * towers of very different heights, walls that are one quad or a grid of windows, and trees, lamps
 * and cars in the streets. Many more cells of a regular code are above each other than beside each
 * other in it, and large triangles touch small ones everywhere.
 */
#include "framework/base/random.h"
#include "framework/scene/scene.h"
#include "scenes/shapes.h"

#include <math.h>

static const bb_option options_table[] = {
    {"n", "200000", NULL, "number of triangles, about; the city grows with it"},
    {"flatness", "0.04", NULL, "highest roof over the side of the city, 0.005 to 1"},
    {"seed", "1", NULL, "seed: what stands where"},
    {0},
};

/* In metres. A block is a square of LOTS * LOTS lots, with streets on all sides. */
static const double block = 80, street = 18, pavement = 3, kerb = 0.15, storey = 3.2;
enum { LOTS = 3, TRIANGLES_PER_BLOCK = 2000, BLOCKS_LEAST = 2, CORRECTIONS = 3 };

/* The output; only counted while `mesh.vertices` is NULL. */
typedef struct city {
    bb_shape_cursor mesh;
    uint32_t blocks; /* per side */
    double side;     /* of the city */
    double tallest;
    uint64_t seed;
} city;

/* ---- shapes ---- */

static void put_box(city *c, double x, double y, double z, double dx, double dy, double dz)
{
    const double lo[3] = {x, y, z}, hi[3] = {x + dx, y + dy, z + dz};
    if (c->mesh.vertices != NULL) {
        bb_shape_box(&c->mesh, lo, hi);
        return;
    }
    c->mesh.vertex_count += BB_SHAPE_BOX_VERTICES;
    c->mesh.triangle_count += BB_SHAPE_BOX_TRIANGLES;
}

static void put_ball(city *c, double x, double y, double z, double radius, uint32_t cuts)
{
    const double centre[3] = {x, y, z};
    if (c->mesh.vertices != NULL) {
        bb_shape_sphere(&c->mesh, centre, radius, cuts);
        return;
    }
    c->mesh.vertex_count += (uint32_t)bb_shape_sphere_vertices(cuts);
    c->mesh.triangle_count += (uint32_t)bb_shape_sphere_triangles(cuts);
}

/* Puts a parallelogram from `at` along u and v, divided into columns * rows quads; its front is on
 * the side that u x v points to. */
static void put_grid(city *c, const double at[3], const double u[3], const double v[3],
                     uint32_t columns, uint32_t rows)
{
    bb_shape_cursor *mesh = &c->mesh;
    uint32_t base = mesh->vertex_count, across = columns + 1;
    if (mesh->vertices == NULL) {
        mesh->vertex_count += across * (rows + 1);
        mesh->triangle_count += 2 * columns * rows;
        return;
    }
    for (uint32_t j = 0; j <= rows; j++)
        for (uint32_t i = 0; i <= columns; i++) {
            float *to = mesh->vertices + 3 * (size_t)mesh->vertex_count++;
            for (int k = 0; k < 3; k++)
                to[k] = (float)(at[k] + u[k] * i / columns + v[k] * j / rows);
        }
    for (uint32_t j = 0; j < rows; j++)
        for (uint32_t i = 0; i < columns; i++) {
            uint32_t *to = mesh->indices + 3 * (size_t)mesh->triangle_count;
            uint32_t corner = base + j * across + i;
            to[0] = to[3] = corner;
            to[1] = corner + 1;
            to[2] = to[4] = corner + across + 1;
            to[5] = corner + across;
            mesh->triangle_count += 2;
        }
}

/* ---- buildings ---- */

typedef struct plan {
    double x, y, z, dx, dy, dz; /* footprint's corner, sides, height */
} plan;

/* Puts four walls and a roof; each wall has the given numbers of quads. */
static void put_hull(city *c, const plan *p, uint32_t along_x, uint32_t along_z, uint32_t rows)
{
    const double up[3] = {0, p->dy, 0};
    const double x[3] = {p->dx, 0, 0}, z[3] = {0, 0, p->dz};
    const double back_x[3] = {-p->dx, 0, 0}, back_z[3] = {0, 0, -p->dz};
    const double corner[4][3] = {{p->x, p->y, p->z + p->dz},
                                 {p->x + p->dx, p->y, p->z + p->dz},
                                 {p->x + p->dx, p->y, p->z},
                                 {p->x, p->y, p->z}};
    const double roof[3] = {p->x, p->y + p->dy, p->z};
    put_grid(c, corner[0], x, up, along_x, rows);
    put_grid(c, corner[1], back_z, up, along_z, rows);
    put_grid(c, corner[2], back_x, up, along_x, rows);
    put_grid(c, corner[3], z, up, along_z, rows);
    put_grid(c, roof, z, x, 1, 1);
}

static uint32_t bays(double length, double width)
{
    double count = floor(length / width);
    return count < 1 ? 1 : (uint32_t)count;
}

/* Window panes are thin boxes in front of the wall, or the wall itself is a grid, or it is one
 * quad. */
static void put_house(city *c, bb_random *random, const plan *p, uint32_t fineness)
{
    uint32_t nx = bays(p->dx, 3.5), nz = bays(p->dz, 3.5), rows = bays(p->dy, storey);
    if (fineness == 0)
        put_hull(c, p, 1, 1, 1);
    else
        put_hull(c, p, nx, nz, rows);
    for (uint32_t j = 0; j < rows && fineness == 2; j++)
        for (uint32_t i = 0; i < nx; i++) {
            double x = p->x + p->dx * (i + 0.25) / nx, y = p->y + p->dy * (j + 0.3) / rows;
            put_box(c, x, y, p->z - 0.05, 0.5 * p->dx / nx, 0.5 * p->dy / rows, 0.04);
            put_box(c, x, y, p->z + p->dz + 0.01, 0.5 * p->dx / nx, 0.5 * p->dy / rows, 0.04);
        }
    uint32_t boxes = bb_random_below(random, 5); /* on the roof */
    for (uint32_t i = 0; i < boxes; i++) {
        double size = bb_random_range(random, 0.5, 2.5);
        put_box(c, bb_random_range(random, p->x, p->x + p->dx - size), p->y + p->dy + 0.01,
                bb_random_range(random, p->z, p->z + p->dz - size), size, 0.6 * size, size);
    }
}

/* Puts a tower that is set back twice on its way up. */
static void put_tower(city *c, bb_random *random, plan p, double height)
{
    static const double shares[] = {0.55, 0.3, 0.15};
    for (int i = 0; i < 3; i++) {
        p.dy = height * shares[i];
        put_house(c, random, &p, bb_random_below(random, 2));
        p.y += p.dy;
        p.x += 0.14 * p.dx;
        p.z += 0.14 * p.dz;
        p.dx *= 0.72;
        p.dz *= 0.72;
    }
}

/* Returns 1 in the middle of the city, 0 at its corners and beyond. */
static double centrality(const city *c, double x, double z)
{
    double u = 2 * x / c->side - 1, v = 2 * z / c->side - 1;
    double near = 1 - 0.5 * (u * u + v * v);
    return near * near * near;
}

static void put_lot(city *c, bb_random *random, double x, double z, double size)
{
    double use = bb_random_unit(random), middle = centrality(c, x, z);
    if (use < 0.12) { /* a small park */
        for (uint32_t i = 0; i < 3; i++) {
            double at[2] = {bb_random_range(random, x + 4, x + size - 4),
                            bb_random_range(random, z + 4, z + size - 4)};
            double height = bb_random_range(random, 2, 5);
            put_box(c, at[0] - 0.2, kerb, at[1] - 0.2, 0.4, height, 0.4);
            put_ball(c, at[0], kerb + height + 1.5, at[1], 2, 2 + bb_random_below(random, 4));
        }
        return;
    }
    double gap = bb_random_range(random, 1, 4);
    plan p = {x + gap, kerb, z + gap, size - 2 * gap, 0, size - 2 * gap};
    /* few are high: the cube of a uniform number, and most of these are in the middle */
    double share = bb_random_unit(random), least = 2 * storey;
    double height = least + (c->tallest - kerb - least) * share * share * share * middle;
    if (height > 12 * storey) {
        put_tower(c, random, p, height);
        return;
    }
    p.dy = height;
    put_house(c, random, &p, bb_random_below(random, 3));
}

/* ---- streets ---- */

static void put_car(city *c, bb_random *random, double x, double z, bool along_x)
{
    double length = bb_random_range(random, 3.5, 5), width = 1.8;
    double dx = along_x ? length : width, dz = along_x ? width : length;
    put_box(c, x, 0.25, z, dx, 0.55, dz);
    put_box(c, x + 0.2 * dx, 0.81, z + 0.2 * dz, 0.6 * dx, 0.5, 0.6 * dz);
}

/* Puts lamps and trees along two sides of a block, and cars in the streets beside them. */
static void put_furniture(city *c, bb_random *random, double x, double z)
{
    enum { PLACES = 6 };
    for (uint32_t i = 0; i < PLACES; i++) {
        double along = block * (i + 0.5) / PLACES, off = 1;
        bool on_x = bb_random_below(random, 2) == 0;
        double at[2] = {x + (on_x ? along : off), z + (on_x ? off : along)};
        if (i % 2 == 0) {
            put_box(c, at[0] - 0.06, kerb, at[1] - 0.06, 0.12, 6, 0.12);
            put_ball(c, at[0], kerb + 6.2, at[1], 0.25, 2);
        } else {
            double height = bb_random_range(random, 2, 4);
            put_box(c, at[0] - 0.15, kerb, at[1] - 0.15, 0.3, height, 0.3);
            put_ball(c, at[0], kerb + height + 1.2, at[1], 1.6, 2 + bb_random_below(random, 4));
        }
        if (bb_random_below(random, 3) != 0)
            put_car(c, random, x + (on_x ? along : -4.5), z + (on_x ? -4.5 : along), on_x);
    }
}

static void put_block(city *c, uint32_t i, uint32_t j)
{
    bb_random random = bb_random_make(c->seed, (uint64_t)j * c->blocks + i);
    double x = street + i * (block + street), z = street + j * (block + street);
    double lot = (block - 2 * pavement) / LOTS;
    put_box(c, x, 0, z, block, kerb, block);
    for (uint32_t v = 0; v < LOTS; v++)
        for (uint32_t u = 0; u < LOTS; u++)
            put_lot(c, &random, x + pavement + u * lot, z + pavement + v * lot, lot);
    put_furniture(c, &random, x, z);
}

/* Puts the roads: wide strips across the whole city, one direction over the other. */
static void put_roads(city *c)
{
    for (uint32_t i = 0; i <= c->blocks; i++) {
        double at = i * (block + street);
        put_grid(c, (double[]){at, -0.01, 0}, (double[]){0, 0, c->side}, (double[]){street, 0, 0},
                 1, 1);
        put_grid(c, (double[]){0, -0.02, at}, (double[]){0, 0, street}, (double[]){c->side, 0, 0},
                 1, 1);
    }
    put_grid(c, (double[]){0, -0.5, 0}, (double[]){0, 0, c->side}, (double[]){c->side, 0, 0}, 1, 1);
}

static void put_city(city *c)
{
    put_roads(c);
    for (uint32_t j = 0; j < c->blocks; j++)
        for (uint32_t i = 0; i < c->blocks; i++)
            put_block(c, i, j);
}

static void count_city(city *c, double flatness, double blocks)
{
    c->blocks = blocks < BLOCKS_LEAST ? BLOCKS_LEAST : (uint32_t)floor(blocks + 0.5);
    c->side = c->blocks * (block + street) + street;
    c->tallest = flatness * c->side;
    c->mesh = (bb_shape_cursor){0};
    put_city(c);
}

static void put_views(const city *c, bb_scene *scene)
{
    double s = c->side, mid = street + (c->blocks / 2) * (block + street) - 0.5 * street;
    const bb_view views[] = {
        {"overall", false, {-0.25 * s, 0.45 * s, 1.3 * s}, {0.5 * s, 0, 0.5 * s}, {0, 1, 0}, 45},
        {"street", false, {mid, 1.7, 0.98 * s}, {mid + 2, 12, 0.3 * s}, {0, 1, 0}, 60},
        {"roofs", false, {0.1 * s, 60, 0.1 * s}, {0.6 * s, 0, 0.55 * s}, {0, 1, 0}, 55},
        {"above", true, {0.5 * s, 2 * s, 0.5 * s}, {0.5 * s, 0, 0.5 * s}, {0, 0, -1}, s},
    };
    scene->view_count = sizeof views / sizeof views[0];
    for (uint32_t i = 0; i < scene->view_count; i++)
        scene->views[i] = views[i];
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    uint64_t n, seed;
    double flatness;
    BB_TRY(bb_spec_u64(spec, options, "n", 10000, 1u << 29, &n));
    BB_TRY(bb_spec_double(spec, options, "flatness", 0.005, 1, &flatness));
    BB_TRY(bb_spec_u64(spec, options, "seed", 0, UINT64_MAX, &seed));
    city c = {.seed = seed};
    /* higher towers have more windows, so a block's triangles depend on the number of blocks */
    double blocks = sqrt((double)n / TRIANGLES_PER_BLOCK);
    for (int i = 0; i <= CORRECTIONS; i++) {
        count_city(&c, flatness, blocks);
        blocks *= sqrt((double)n / c.mesh.triangle_count);
    }
    BB_TRY(bb_scene_reserve_mesh(scene, c.mesh.vertex_count, c.mesh.triangle_count));
    c.mesh = bb_shape_start(scene, NULL);
    put_city(&c);
    put_views(&c, scene);
    return BB_OK;
}

extern const bb_generator bb_generator_city;
const bb_generator bb_generator_city = {
    .name = "city",
    .summary = "large flat city: streets, houses and towers, small objects beside large ones",
    .options = options_table,
    .make = make,
};
