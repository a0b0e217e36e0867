// tinybvh (Bikker) as a tracer of bvhbench: its BVHs of 2, 4 and 8 children on the CPU.
#include "framework/builder/tracer.h"
#define TINYBVH_IMPLEMENTATION
#include "tiny_bvh.h"

#include <memory>
#include <variant>
#include <vector>

using namespace tinybvh;

static const bb_option options[] = {
    {"layout", "bvh8", "bvh2|bvh4|bvh8", "BVH, BVH4_CPU (SSE) or BVH8_CPU (AVX2)"},
    {"quality", "sah", "sah|sbvh", "binned SAH, or BuildHQ(), with spatial splits"},
    {"optimize", "0", nullptr, "iterations of Optimize() after it: 0 to 10000"},
    {nullptr, nullptr, nullptr, nullptr},
};

// BVH, built as it is within the wide ones: by SIMD. BVH::Build() is the reference code.
struct Bvh2 : BVH {
    void Build(const bvhvec4slice &slice, const uint32_t *indices, uint32_t count)
    {
        BuildDefault(slice, indices, count);
    }
};

struct Tracer {
    const bb_tracer_context *c;
    uint64_t optimize;
    std::vector<bvhvec4> vertices;
    std::variant<std::unique_ptr<Bvh2>, std::unique_ptr<BVH4_CPU>, std::unique_ptr<BVH8_CPU>> bvh;
};

static bb_status create(const bb_tracer_context *c, void **self)
{
    Tracer *t = new Tracer{c};
    *self = t;
    BB_TRY(bb_spec_u64(c->spec, c->options, "optimize", 0, 10000, &t->optimize));
    if (bb_spec_is(c->spec, c->options, "layout", "bvh4"))
        t->bvh.emplace<1>();
    else if (bb_spec_is(c->spec, c->options, "layout", "bvh8"))
        t->bvh.emplace<2>();
    t->vertices.resize(c->scene->vertex_count);
    return BB_OK;
}

static bb_status build(void *self, bb_phases *)
{
    Tracer *t = static_cast<Tracer *>(self);
    const float *v = t->c->scene->vertices;
    for (bvhvec4 &to : t->vertices)
        to = {v[0], v[1], v[2], 0}, v += 3;
    const bvhvec4slice slice(t->vertices.data(), (uint32_t)t->vertices.size());
    const uint32_t count = t->c->scene->prim_count, *indices = bb_scene_indices(t->c->scene);
    const bool splits = bb_spec_is(t->c->spec, t->c->options, "quality", "sbvh");
    const auto build_in = [=](auto &bvh) {
        bvh = std::make_unique<std::decay_t<decltype(*bvh)>>();
        if constexpr (requires { bvh->bvh8; })
            bvh->bvh8.bvh.threadedBuild = t->c->threads > 1;
        else if constexpr (requires { bvh->bvh4; })
            bvh->bvh4.bvh.threadedBuild = t->c->threads > 1;
        else
            bvh->threadedBuild = t->c->threads > 1;
        splits ? bvh->BuildHQ(slice, indices, count) : bvh->Build(slice, indices, count);
        if (t->optimize > 0)
            bvh->Optimize((uint32_t)t->optimize, false);
    };
    std::visit(build_in, t->bvh);
    return BB_OK;
}

// tinybvh's rays begin at their origin. Distances are in units of the direction, but BVH tests
// triangles with an absolute epsilon, which is meant for directions of length 1.
static bb_status trace(void *self, const bb_ray *rays, uint32_t count, bool any, bb_hit *hits)
{
    const auto trace_in = [=](const auto &bvh) {
        constexpr bool epsilon = std::is_base_of_v<BVH, std::decay_t<decltype(*bvh)>>;
        Ray ray;
        for (uint32_t i = 0; i < count; i++) {
            const bb_ray &r = rays[i];
            const bvhvec3 d(r.d[0], r.d[1], r.d[2]), o(r.o[0], r.o[1], r.o[2]);
            const float scale = epsilon ? 1 / tinybvh_length(d) : 1;
            const float most = tinybvh_min((r.tmax - r.tmin) / scale, BVH_FAR);
            ray.O = o + d * r.tmin, ray.D = d * scale, ray.rD = tinybvh_rcp(ray.D);
            ray.hit.t = most;
            const bool hit = any ? bvh->IsOccluded(ray) : (bvh->Intersect(ray), ray.hit.t < most);
            hits[i] = !hit  ? bb_hit{INFINITY, BB_NONE}
                      : any ? bb_hit{0, BB_UNNAMED}
                            : bb_hit{r.tmin + ray.hit.t * scale, ray.hit.prim};
        }
    };
    std::visit(trace_in, static_cast<const Tracer *>(self)->bvh);
    return BB_OK;
}

static bb_status describe(void *, char *text, size_t capacity)
{
    snprintf(text, capacity, "tinybvh %d.%d.%d", TINY_BVH_VERSION_MAJOR, TINY_BVH_VERSION_MINOR,
             TINY_BVH_VERSION_SUB);
    return BB_OK;
}

static void destroy(void *self)
{
    delete static_cast<Tracer *>(self);
}

extern "C" const bb_tracer bb_tracer_tinybvh = {
    .abi_version = BB_TRACER_ABI_VERSION,
    .name = "tinybvh",
    .summary = "tinybvh: BVHs of 2, 4 and 8 children, by SSE and AVX2",
    .paper = "Fuetterling et al. 2017; Stich et al. 2009",
    .kinds = BB_TRIANGLES,
    .options = options,
    .create = create,
    .build = build,
    .trace = trace,
    .describe = describe,
    .destroy = destroy,
};
