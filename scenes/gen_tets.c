/* A mesh of tetrahedra: cubes of a lattice, each cut into six around its diagonal (Kuhn 1960, "Some
 * Combinatorial Lemmas in Topology"), so that neighbours share their faces. The cubes form a block,
 * a ball or a shell; `jitter` moves the corners, `grade` makes each cube wider along x than the one
 * before. Faults of real meshes are made on request: tetrahedra with reversed orientation, some
 * without a volume, and copies. */
#include "framework/base/random.h"
#include "framework/scene/tets.h"

#include <math.h>

enum { SIDE_MAX = 400, KUHN = 6 };

static const bb_option options_table[] = {
    {"side", "12", NULL, "cubes along an edge, 1 to 400"},
    {"shape", "ball", "block|ball|shell", "which cubes exist"},
    {"jitter", "0.2", NULL, "corners are moved by up to half of this, in sides of a cube; 0 to 1"},
    {"grade", "1", NULL, "width of each cube along x over that before it, 0.1 to 10"},
    {"thin", "0", NULL, "heights along z are divided by 2^N, 0 to 140"},
    {"flip", "0", NULL, "every N-th has reversed orientation; 0: none"},
    {"flat", "0", NULL, "every N-th is followed by one without a volume; 0: none"},
    {"twins", "0", NULL, "every N-th is followed by a copy of it; 0: none"},
    {"seed", "1", NULL, "seed"},
    {0},
};

typedef struct lattice {
    uint64_t side, thin, flip, flat, twins, seed;
    bool ball, shell;
    double jitter, grade;
} lattice;

static bb_status read_options(const bb_spec *spec, const bb_option *options, lattice *l)
{
    l->ball = bb_spec_is(spec, options, "shape", "ball");
    l->shell = bb_spec_is(spec, options, "shape", "shell");
    BB_TRY(bb_spec_u64(spec, options, "side", 1, SIDE_MAX, &l->side));
    BB_TRY(bb_spec_double(spec, options, "jitter", 0, 1, &l->jitter));
    BB_TRY(bb_spec_double(spec, options, "grade", 0.1, 10, &l->grade));
    BB_TRY(bb_spec_u64(spec, options, "thin", 0, 140, &l->thin));
    BB_TRY(bb_spec_u64(spec, options, "flip", 0, UINT32_MAX, &l->flip));
    BB_TRY(bb_spec_u64(spec, options, "flat", 0, UINT32_MAX, &l->flat));
    BB_TRY(bb_spec_u64(spec, options, "twins", 0, UINT32_MAX, &l->twins));
    return bb_spec_u64(spec, options, "seed", 0, UINT64_MAX, &l->seed);
}

/* Returns whether the cube with this lowest corner exists: by its centre, in half sides. */
static bool has_cube(const lattice *l, const uint64_t at[3])
{
    int64_t square = 0, side = (int64_t)l->side;
    for (int k = 0; k < 3; k++) {
        int64_t from_middle = 2 * (int64_t)at[k] + 1 - side;
        square += from_middle * from_middle;
    }
    if (l->shell)
        return square <= side * side && 4 * square > side * side;
    return !l->ball || square <= side * side;
}

static uint32_t vertex_of(const lattice *l, const uint64_t at[3])
{
    return (uint32_t)((at[2] * (l->side + 1) + at[1]) * (l->side + 1) + at[0]);
}

/* Only sums, products and powers of two, so that they are the same on every machine. */
static void put_vertices(const lattice *l, bb_scene *scene)
{
    for (uint64_t z = 0; z <= l->side; z++)
        for (uint64_t y = 0; y <= l->side; y++) {
            double x0 = 0, width = 1;
            for (uint64_t x = 0; x <= l->side; x++) {
                const uint64_t at[3] = {x, y, z};
                uint32_t number = vertex_of(l, at);
                bb_random random = bb_random_make(l->seed, number);
                const double place[3] = {x0, (double)y, (double)z}, wide[3] = {width, 1, 1};
                for (int k = 0; k < 3; k++) {
                    double moved = l->jitter * wide[k] * (bb_random_unit(&random) - 0.5);
                    double at = ldexp(place[k] + moved, k == 2 ? -(int)l->thin : 0);
                    scene->vertices[3 * (size_t)number + (size_t)k] = (float)at;
                }
                x0 += width;
                width *= l->grade;
            }
        }
}

/* Gets the n-th of the six in a cube: from its lowest corner to its highest along the axes in an
 * order; every second order gives the other orientation. */
static void cut(const lattice *l, const uint64_t cube[3], int n, uint32_t tet[4])
{
    static const int orders[KUHN][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                        {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    uint64_t at[3] = {cube[0], cube[1], cube[2]};
    for (int c = 0; c < 4; c++) {
        tet[c] = vertex_of(l, at);
        if (c < 3)
            at[orders[n][c]]++;
    }
    if (n >= 3) {
        uint32_t swap = tet[1];
        tet[1] = tet[2];
        tet[2] = swap;
    }
}

static bool is_nth(uint64_t number, uint64_t n)
{
    return n != 0 && number % n == n - 1;
}

/* Adds a tetrahedron and those that follow it. `to` NULL: counts only. */
static void add(const lattice *l, uint64_t number, const uint32_t tet[4], uint32_t *to,
                uint64_t *count)
{
    const bool there[3] = {true, is_nth(number, l->flat), is_nth(number, l->twins)};
    const bool flipped = is_nth(number, l->flip);
    for (int which = 0; which < 3; which++) {
        if (!there[which])
            continue;
        for (int c = 0; c < 4 && to != NULL; c++) {
            int from = flipped && c < 2 ? 1 - c : c;
            to[4 * *count + (uint64_t)c] = tet[which == 1 && c == 3 ? 0 : from];
        }
        ++*count;
    }
}

static uint64_t put_tets(const lattice *l, uint32_t *to)
{
    uint64_t count = 0, number = 0;
    for (uint64_t i = 0; i < l->side * l->side * l->side; i++) {
        const uint64_t cube[3] = {i % l->side, i / l->side % l->side, i / l->side / l->side};
        if (!has_cube(l, cube))
            continue;
        for (int n = 0; n < KUHN; n++) {
            uint32_t tet[4];
            cut(l, cube, n, tet);
            add(l, number++, tet, to, &count);
        }
    }
    return count;
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    lattice l;
    BB_TRY(read_options(spec, options, &l));
    uint64_t corners = (l.side + 1) * (l.side + 1) * (l.side + 1);
    BB_TRY(bb_scene_reserve(scene, corners,
                            &(bb_prim_counts){.of = {[BB_TETRAHEDRON] = put_tets(&l, NULL)}}));
    put_vertices(&l, scene);
    put_tets(&l, (uint32_t *)scene->prims[BB_TETRAHEDRON].data);
    return BB_OK;
}

extern const bb_generator bb_generator_tets;
const bb_generator bb_generator_tets = {
    .name = "tets",
    .summary = "mesh of tetrahedra: a block, ball or shell; graded, flipped, flat or doubled",
    .options = options_table,
    .make = make,
};
