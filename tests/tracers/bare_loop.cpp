// What an adapter costs: its trace() beside a loop that only calls the library, on the same rays
// and the same tree, on one thread, by processor time, in pairs whose order alternates.
//   bare_loop ADAPTER.so RAYS TRACER:key=value,...
// RAYS is of `bvhbench rays`. Prints the median of the ratios of 30 pairs, adapter to loop, its
// 95 % interval (ranks 10 and 21), and on how many rays they differ. tests/tracers/bare_loop.sh
// builds it, with BARE_TINYBVH or BARE_MADMANN91.
#include "framework/builder/tracer.h"

#if defined(BARE_TINYBVH)
#define TINYBVH_IMPLEMENTATION
#include "tiny_bvh.h"
#else
#include <bvh/v2/default_builder.h>
#include <bvh/v2/stack.h>
#include <bvh/v2/tri.h>
#endif

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <dlfcn.h>
#include <fstream>
#include <iterator>
#include <vector>

enum { PAIRS = 30, CHUNK = 1024 };

static void fail(const char *what)
{
    std::fprintf(stderr, "bare_loop: %s\n", what);
    std::exit(2);
}

#if defined(BARE_TINYBVH)
struct Bare {
    std::vector<tinybvh::bvhvec4> vertices;
    tinybvh::BVH8_CPU bvh;

    Bare(const float *v, size_t vertex_count, const uint32_t *indices, uint32_t triangles)
    {
        for (size_t i = 0; i < vertex_count; i++)
            vertices.push_back({v[3 * i], v[3 * i + 1], v[3 * i + 2], 0});
        bvh.Build(tinybvh::bvhvec4slice(vertices.data(), (uint32_t)vertex_count), indices,
                  triangles);
    }
    void trace(const bb_ray *rays, size_t count, bb_hit *hits) const
    {
        tinybvh::Ray ray; // its constructor costs a tenth of the time
        for (size_t i = 0; i < count; i++) {
            ray.O = {rays[i].o[0], rays[i].o[1], rays[i].o[2]};
            ray.D = {rays[i].d[0], rays[i].d[1], rays[i].d[2]};
            ray.rD = tinybvh::tinybvh_rcp(ray.D);
            ray.hit.t = rays[i].tmax;
            bvh.Intersect(ray);
            hits[i] = {ray.hit.t, ray.hit.prim};
        }
    }
};
#else
using namespace bvh::v2;
struct Bare {
    Bvh<Node<float, 3>> bvh;
    std::vector<PrecomputedTri<float>> triangles;

    Bare(const float *v, size_t, const uint32_t *indices, uint32_t count)
    {
        std::vector<Tri<float, 3>> all;
        std::vector<BBox<float, 3>> boxes;
        std::vector<Vec<float, 3>> centres;
        const auto at = [&](uint32_t i) {
            return Vec<float, 3>(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
        };
        for (uint32_t i = 0; i < count; i++) {
            all.push_back({at(indices[3 * i]), at(indices[3 * i + 1]), at(indices[3 * i + 2])});
            boxes.push_back(all[i].get_bbox()), centres.push_back(all[i].get_center());
        }
        ThreadPool pool(1);
        bvh = DefaultBuilder<Node<float, 3>>::build(pool, boxes, centres, {});
        for (size_t i = 0; i < count; i++)
            triangles.push_back(all[bvh.prim_ids[i]]);
    }
    void trace(const bb_ray *rays, size_t count, bb_hit *hits) const
    {
        for (size_t n = 0; n < count; n++) {
            const bb_ray &r = rays[n];
            Ray<float, 3> ray({r.o[0], r.o[1], r.o[2]}, {r.d[0], r.d[1], r.d[2]}, r.tmin, r.tmax);
            SmallStack<Node<float, 3>::Index, 64> stack;
            size_t nearest = SIZE_MAX;
            bvh.intersect<false, true>(ray, bvh.get_root().index, stack, [&](size_t i, size_t end) {
                for (; i < end; i++)
                    if (auto hit = triangles[i].intersect(ray))
                        ray.tmax = std::get<0>(*hit), nearest = i;
                return false;
            });
            hits[n] = {ray.tmax, nearest != SIZE_MAX ? (uint32_t)bvh.prim_ids[nearest] : BB_NONE};
        }
    }
};
#endif

static double cpu_ms()
{
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

int main(int argc, char **argv)
{
    if (argc != 4)
        fail("usage: bare_loop ADAPTER.so RAYS TRACER:key=value,...");
    void *library = dlopen(argv[1], RTLD_NOW);
    const auto *plugin =
        library ? (const bb_tracer_registration *)dlsym(library, "bb_plugin") : nullptr;
    if (plugin == nullptr)
        fail("the adapter does not load");
    std::ifstream file(argv[2], std::ios::binary);
    std::vector<char> data((std::istreambuf_iterator<char>(file)), {});
    if (data.size() < 1024 || std::memcmp(data.data(), "BVHBRAYS", 8) != 0)
        fail("no rays file");
    uint64_t counts[3]; // rays, vertices, triangles: framework/workload/exchange.h
    std::memcpy(counts, data.data() + 32, sizeof counts);
    const bb_ray *rays = (const bb_ray *)(data.data() + 1024);
    float *vertices = (float *)(data.data() + 1024 + 32 * counts[0]);
    uint32_t *indices = (uint32_t *)(vertices + 3 * counts[1]);
    const Bare bare(vertices, counts[1], indices, (uint32_t)counts[2]);

    static bb_scene scene; // what an adapter reads of a scene
    scene.prim_count = scene.prims[BB_TRIANGLE].count = (uint32_t)counts[2];
    scene.kinds = BB_TRIANGLES;
    scene.prims[BB_TRIANGLE].data = indices;
    scene.vertices = vertices;
    scene.vertex_count = (uint32_t)counts[1];
    bb_spec spec;
    if (bb_spec_parse(argv[3], &spec) != BB_OK)
        fail(bb_message());
    const bb_tracer *tracer = plugin->tracer;
    const bb_tracer_context context = {&scene, &spec, tracer->options, 1};
    void *self = nullptr;
    if (tracer->create(&context, &self) != BB_OK || tracer->build(self, nullptr) != BB_OK)
        fail("the adapter does not build");

    std::vector<bb_hit> of_adapter(counts[0]), of_loop(counts[0]);
    const auto by_adapter = [&] {
        for (size_t i = 0; i < counts[0]; i += CHUNK)
            tracer->trace(self, rays + i, (uint32_t)std::min<size_t>(CHUNK, counts[0] - i), false,
                          of_adapter.data() + i);
    };
    const auto by_loop = [&] { bare.trace(rays, counts[0], of_loop.data()); };
    const auto clocked = [](const auto &work) {
        const double start = cpu_ms();
        work();
        return cpu_ms() - start;
    };
    by_adapter(), by_loop();
    std::vector<double> ratios;
    for (int pair = 0; pair < PAIRS; pair++) {
        double adapter = pair % 2 == 0 ? clocked(by_adapter) : 0;
        const double loop = clocked(by_loop);
        adapter = pair % 2 == 0 ? adapter : clocked(by_adapter);
        ratios.push_back(adapter / loop);
    }
    size_t differ = 0;
    for (size_t i = 0; i < counts[0]; i++)
        differ += of_adapter[i].prim != BB_NONE && of_adapter[i].prim != of_loop[i].prim;
    std::sort(ratios.begin(), ratios.end());
    std::printf("%s: %.4f [%.4f, %.4f] of the loop's time, %zu of %zu rays differ\n", argv[3],
                (ratios[14] + ratios[15]) / 2, ratios[9], ratios[20], differ, (size_t)counts[0]);
    tracer->destroy(self);
}
