// bvh, version 2 (Pérard-Gayot, github.com/madmann91/bvh), as a tracer of bvhbench.
#include "framework/builder/tracer.h"
#include <bvh/v2/default_builder.h>
#include <bvh/v2/stack.h>
#include <bvh/v2/tri.h>

using namespace bvh::v2;
using Builder = DefaultBuilder<Node<float, 3>>;

static const bb_option options[] = {
    {"quality", "high", "low|medium|high", "of DefaultBuilder: binned SAH, sweep SAH, reinsertion"},
    {"mode", "robust", "fast|robust", "robust: boxes are not missed for rounding"},
    {nullptr, nullptr, nullptr, nullptr},
};

struct Tracer {
    const bb_scene *scene;
    ThreadPool pool;
    bool robust = true;
    Builder::Config config = {};
    std::vector<PrecomputedTri<float>> triangles = {}; // in the order of the leaves
    Bvh<Node<float, 3>> bvh = {};

    Tri<float, 3> triangle(uint32_t i) const
    {
        const float *a = bb_scene_vertex(scene, i, 0), *b = bb_scene_vertex(scene, i, 1);
        const float *c = bb_scene_vertex(scene, i, 2);
        return {{a[0], a[1], a[2]}, {b[0], b[1], b[2]}, {c[0], c[1], c[2]}};
    }

    void build()
    {
        const size_t count = scene->prim_count;
        ParallelExecutor executor(pool);
        std::vector<BBox<float, 3>> boxes(count);
        std::vector<Vec<float, 3>> centres(count);
        executor.for_each(0, count, [&](size_t i, size_t end) {
            for (; i < end; i++) {
                const Tri<float, 3> t = triangle((uint32_t)i);
                boxes[i] = t.get_bbox(), centres[i] = t.get_center();
            }
        });
        bvh = Builder::build(pool, boxes, centres, config);
        triangles.resize(count);
        executor.for_each(0, count, [&](size_t i, size_t end) {
            for (; i < end; i++)
                triangles[i] = triangle((uint32_t)bvh.prim_ids[i]);
        });
    }

    template <bool Any, bool Robust>
    void trace(const bb_ray *rays, uint32_t count, bb_hit *hits) const
    {
        for (uint32_t n = 0; n < count; n++) {
            const bb_ray &r = rays[n];
            Ray<float, 3> ray({r.o[0], r.o[1], r.o[2]}, {r.d[0], r.d[1], r.d[2]}, r.tmin, r.tmax);
            SmallStack<Node<float, 3>::Index, 64> stack; // as in its examples
            size_t nearest = SIZE_MAX;                   // place in `triangles`
            bvh.intersect<Any, Robust>(ray, bvh.get_root().index, stack, [&](size_t i, size_t end) {
                for (; i < end; i++)
                    if (auto hit = triangles[i].intersect(ray)) {
                        ray.tmax = std::get<0>(*hit);
                        nearest = i;
                        if (Any)
                            return true;
                    }
                return false;
            });
            const bool hit = nearest != SIZE_MAX;
            hits[n] = {hit ? ray.tmax : INFINITY, hit ? (uint32_t)bvh.prim_ids[nearest] : BB_NONE};
        }
    }
};

static bb_status create(const bb_tracer_context *c, void **self)
{
    Tracer *t = new Tracer{c->scene, ThreadPool(c->threads)};
    *self = t;
    t->robust = bb_spec_is(c->spec, c->options, "mode", "robust");
    if (bb_spec_is(c->spec, c->options, "quality", "low"))
        t->config.quality = Builder::Quality::Low;
    else if (bb_spec_is(c->spec, c->options, "quality", "medium"))
        t->config.quality = Builder::Quality::Medium;
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
    if (t->robust)
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
    .abi_version = BB_TRACER_ABI_VERSION,
    .name = "madmann91",
    .summary = "bvh by Pérard-Gayot, version 2: binary BVHs, scalar code",
    .paper = "Meister and Bittner 2018 (reinsertion); Ize 2013 (robust)",
    .kinds = BB_TRIANGLES,
    .options = options,
    .exactness = "mode",
    .create = create,
    .build = build,
    .trace = trace,
    .destroy = destroy,
};
