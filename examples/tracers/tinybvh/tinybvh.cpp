// tinybvh (Bikker) as a tracer of bvhbench: its BVHs of 2, 4 and 8 children on the CPU.
#include "framework/builder/tracer.h"
#define TINYBVH_IMPLEMENTATION
#include "tiny_bvh.h"

#include <memory>
#include <vector>

namespace
{

const bb_option options[] = {
    {"layout", "bvh8", "bvh2|bvh4|bvh8", "BVH, BVH4_CPU (SSE) or BVH8_CPU (AVX2)"},
    {"quality", "sah", "sah|sbvh", "Build(), binned SAH, or BuildHQ(), with spatial splits"},
    {"optimize", "0", nullptr, "iterations of Optimize() after it: 0 to 10000"},
    {nullptr, nullptr, nullptr, nullptr},
};

struct Tracer {
    virtual ~Tracer() = default;
    virtual void build() = 0;
    virtual void trace(const bb_ray *rays, uint32_t count, bool any, bb_hit *hits) const = 0;
    const bb_tracer_context *c;
    std::vector<tinybvh::bvhvec4> vertices;
    uint32_t optimize;
};

template <typename Bvh> struct Of : Tracer {
    std::unique_ptr<Bvh> bvh;
    void build() override
    {
        const tinybvh::bvhvec4slice slice(vertices.data(), (uint32_t)vertices.size());
        const bool splits = bb_spec_is(c->spec, c->options, "quality", "sbvh");
        const uint32_t count = c->scene->prim_count, *indices = bb_scene_indices(c->scene);
        bvh = std::make_unique<Bvh>();
        splits ? bvh->BuildHQ(slice, indices, count) : bvh->Build(slice, indices, count);
        if (optimize > 0)
            bvh->Optimize(optimize, false);
    }

    // tinybvh's rays begin at their origin, and their directions get the length 1.
    void trace(const bb_ray *rays, uint32_t count, bool any, bb_hit *hits) const override
    {
        for (uint32_t i = 0; i < count; i++) {
            const bb_ray &r = rays[i];
            const tinybvh::bvhvec3 d(r.d[0], r.d[1], r.d[2]), o(r.o[0], r.o[1], r.o[2]);
            const float length = tinybvh::tinybvh_length(d);
            const float most = tinybvh::tinybvh_min((r.tmax - r.tmin) * length, BVH_FAR);
            tinybvh::Ray ray(o + d * r.tmin, d, most);
            hits[i] = {INFINITY, BB_NONE};
            if (any && bvh->IsOccluded(ray))
                hits[i] = {0, BB_UNNAMED};
            else if (!any && (bvh->Intersect(ray), ray.hit.t < most))
                hits[i] = {r.tmin + ray.hit.t / length, ray.hit.prim};
        }
    }
};

bb_status create(const bb_tracer_context *c, void **self)
{
    const bool two = bb_spec_is(c->spec, c->options, "layout", "bvh2");
    const bool four = bb_spec_is(c->spec, c->options, "layout", "bvh4");
    uint64_t optimize;
    BB_TRY(bb_spec_u64(c->spec, c->options, "optimize", 0, 10000, &optimize));
    Tracer *t = two    ? static_cast<Tracer *>(new Of<tinybvh::BVH>)
                : four ? static_cast<Tracer *>(new Of<tinybvh::BVH4_CPU>)
                       : new Of<tinybvh::BVH8_CPU>;
    *self = t;
    t->c = c;
    t->optimize = (uint32_t)optimize;
    const float *v = c->scene->vertices, *end = v + 3 * c->scene->vertex_count;
    for (; v < end; v += 3)
        t->vertices.push_back({v[0], v[1], v[2], 0});
    return BB_OK;
}

bb_status build(void *self, bb_phases *)
{
    static_cast<Tracer *>(self)->build();
    return BB_OK;
}

bb_status trace(void *self, const bb_ray *rays, uint32_t count, bool any, bb_hit *hits)
{
    static_cast<const Tracer *>(self)->trace(rays, count, any, hits);
    return BB_OK;
}

bb_status describe(void *, char *text, size_t capacity)
{
    snprintf(text, capacity, "tinybvh %d.%d.%d", TINY_BVH_VERSION_MAJOR, TINY_BVH_VERSION_MINOR,
             TINY_BVH_VERSION_SUB);
    return BB_OK;
}

void destroy(void *self)
{
    delete static_cast<Tracer *>(self);
}

} // namespace

extern "C" const bb_tracer bb_tracer_tinybvh = {
    BB_TRACER_ABI_VERSION,
    "tinybvh",
    "tinybvh: BVHs of 2, 4 and 8 children, by SSE and AVX2",
    "Fuetterling et al. 2017; Stich et al. 2009",
    BB_TRIANGLES,
    options,
    nullptr,
    nullptr,
    nullptr,
    nullptr,
    create,
    build,
    nullptr,
    trace,
    nullptr,
    describe,
    destroy};
