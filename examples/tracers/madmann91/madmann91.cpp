// bvh, version 2 (Pérard-Gayot, github.com/madmann91/bvh), as a tracer of bvhbench.
#include "framework/builder/tracer.h"
#include <bvh/v2/default_builder.h>
#include <bvh/v2/stack.h>
#include <bvh/v2/tri.h>

using namespace bvh::v2;
using Builder = DefaultBuilder<Node<float, 3>>;
using Vec3 = Vec<float, 3>;

static const bb_option options[] = {
    {"quality", "high", "low|medium|high", "of DefaultBuilder: binned SAH, sweep SAH, reinsertion"},
    {"mode", "robust", "fast|robust", "robust: boxes are not missed for rounding"},
    {nullptr, nullptr, nullptr, nullptr},
};

struct Tracer {
    const bb_tracer_context *c;
    ThreadPool pool;
    Builder::Config config = {};
    std::vector<Tri<float, 3>> input = {};
    std::vector<PrecomputedTri<float>> triangles = {}; // in the order of the leaves
    Bvh<Node<float, 3>> bvh = {};

    void build()
    {
        ParallelExecutor executor(pool);
        std::vector<BBox<float, 3>> boxes(input.size());
        std::vector<Vec3> centres(input.size());
        executor.for_each(0, input.size(), [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; i++) {
                boxes[i] = input[i].get_bbox();
                centres[i] = input[i].get_center();
            }
        });
        bvh = Builder::build(pool, boxes, centres, config);
        triangles.resize(input.size());
        executor.for_each(0, input.size(), [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; i++)
                triangles[i] = input[bvh.prim_ids[i]];
        });
    }

    template <bool Any, bool Robust>
    void trace(const bb_ray *rays, uint32_t count, bb_hit *hits) const
    {
        for (uint32_t n = 0; n < count; n++) {
            const bb_ray &r = rays[n];
            Ray<float, 3> ray({r.o[0], r.o[1], r.o[2]}, {r.d[0], r.d[1], r.d[2]}, r.tmin, r.tmax);
            SmallStack<Node<float, 3>::Index, 64> stack; // as in its examples
            hits[n] = {INFINITY, BB_NONE};
            bvh.intersect<Any, Robust>(ray, bvh.get_root().index, stack, [&](size_t i, size_t end) {
                for (; i < end; i++)
                    if (auto hit = triangles[i].intersect(ray)) {
                        ray.tmax = std::get<0>(*hit);
                        hits[n] = {ray.tmax, (uint32_t)bvh.prim_ids[i]};
                    }
                return hits[n].prim != BB_NONE;
            });
        }
    }
};

static bb_status create(const bb_tracer_context *c, void **self)
{
    Tracer *t = new Tracer{.c = c, .pool = ThreadPool(c->threads)};
    *self = t;
    if (bb_spec_is(c->spec, c->options, "quality", "low"))
        t->config.quality = Builder::Quality::Low;
    else if (bb_spec_is(c->spec, c->options, "quality", "medium"))
        t->config.quality = Builder::Quality::Medium;
    for (uint32_t i = 0; i < c->scene->prim_count; i++) {
        const auto corner = [=](uint32_t k) {
            const float *v = bb_scene_vertex(c->scene, i, k);
            return Vec3(v[0], v[1], v[2]);
        };
        t->input.emplace_back(corner(0), corner(1), corner(2));
    }
    return BB_OK;
}

static bb_status build(void *self, bb_phases *)
{
    static_cast<Tracer *>(self)->build();
    return BB_OK;
}

static bb_status trace(void *self, const bb_ray *rays, uint32_t count, bool any, bb_hit *hits)
{
    const Tracer *t = static_cast<const Tracer *>(self);
    if (bb_spec_is(t->c->spec, t->c->options, "mode", "robust"))
        any ? t->trace<true, true>(rays, count, hits) : t->trace<false, true>(rays, count, hits);
    else
        any ? t->trace<true, false>(rays, count, hits) : t->trace<false, false>(rays, count, hits);
    return BB_OK;
}

static void destroy(void *self)
{
    delete static_cast<Tracer *>(self);
}

extern "C" const bb_tracer bb_tracer_madmann91 = {
    BB_TRACER_ABI_VERSION,
    "madmann91",
    "bvh by Pérard-Gayot, version 2: binary BVHs, scalar code",
    "Meister and Bittner 2018 (reinsertion); Ize 2013 (robust)",
    BB_TRIANGLES,
    options,
    nullptr,
    "mode",
    nullptr,
    nullptr,
    create,
    build,
    nullptr,
    trace,
    nullptr,
    nullptr,
    destroy};
