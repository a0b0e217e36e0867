/* The triangles of a glTF 2.0 model (specification sections 3.5 to 3.7): nodes with their
 * transforms; lists, strips and fans.
 *
 * Two passes: the first counts, so that all memory is asked for once and refused beforehand; the
 * second fills.
 */
#include "scenes/gltf_accessors.hpp"
#include "scenes/gltf_nodes.hpp"

extern "C" {
#include "scenes/gltf.h"
}

#include <algorithm>
#include <cmath>
#include <map>
#include <new>

namespace bb_gltf
{
namespace
{
/* One primitive of one node, with its place in the scene. */
struct Part {
    int node;
    int mesh;
    int primitive;
    uint64_t vertex_base;
    bool shared; /* an earlier part of this node has put the same positions there */
    uint64_t triangle_base;
};

class Loader
{
  public:
    Loader(const char *path, const Document &document)
        : path_(path), model_(document.model), accessors_(path, document)
    {
    }

    void plan();
    void fill(float *vertices, uint32_t *triangles) const;
    uint64_t vertex_count() const
    {
        return vertex_count_;
    }
    uint64_t triangle_count() const
    {
        return triangle_count_;
    }
    uint32_t ignored() const
    {
        return static_cast<uint32_t>(std::min<uint64_t>(no_surface_ + no_positions_, UINT32_MAX));
    }
    const Placement &placement() const
    {
        return placement_;
    }

  private:
    std::string name_of(const Part &part) const;
    void plan_part(const Part &part, std::map<int, uint64_t> &bases);
    uint64_t triangles_of(int mode, uint64_t corners, const std::string &what) const;
    void fill_positions(const Part &part, int accessor, float *vertices) const;
    void fill_triangles(const Part &part, uint64_t vertex_count, int accessor, int mode,
                        uint32_t *out) const;

    const char *path_;
    const tinygltf::Model &model_;
    const Accessors accessors_;
    Placement placement_;
    std::vector<Part> parts_;
    uint64_t vertex_count_ = 0;
    uint64_t triangle_count_ = 0;
    uint64_t no_surface_ = 0; /* primitives left out: points and lines */
    uint64_t no_positions_ = 0;
};

std::string Loader::name_of(const Part &part) const
{
    const std::string &name = model_.meshes[static_cast<size_t>(part.mesh)].name;
    return "mesh " + std::to_string(part.mesh) +
           (name.empty() ? "" : " (" + name.substr(0, 80) + ")") + ", primitive " +
           std::to_string(part.primitive);
}

/* ---- first pass: count ---- */

uint64_t Loader::triangles_of(int mode, uint64_t corners, const std::string &what) const
{
    if (corners < 3 || (mode == TINYGLTF_MODE_TRIANGLES && corners % 3 != 0))
        fail(BB_INVALID, "%s: %s: %llu corners make no whole number of triangles", path_,
             what.c_str(), static_cast<unsigned long long>(corners));
    return mode == TINYGLTF_MODE_TRIANGLES ? corners / 3 : corners - 2;
}

void Loader::plan_part(const Part &place, std::map<int, uint64_t> &bases)
{
    Part part = place;
    const tinygltf::Primitive &primitive = model_.meshes[static_cast<size_t>(part.mesh)]
                                               .primitives[static_cast<size_t>(part.primitive)];
    const auto position = primitive.attributes.find("POSITION");
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
        no_surface_++;
        return;
    }
    if (position == primitive.attributes.end()) {
        no_positions_++;
        return;
    }
    const std::string what = name_of(part);
    accessors_.check_positions(position->second, what + ", POSITION");
    const uint64_t vertices = model_.accessors[static_cast<size_t>(position->second)].count;
    uint64_t corners = vertices;
    if (primitive.indices >= 0) {
        accessors_.check_indices(primitive.indices, what + ", indices");
        corners = model_.accessors[static_cast<size_t>(primitive.indices)].count;
    }
    part.triangle_base = triangle_count_;
    triangle_count_ += triangles_of(primitive.mode, corners, what);
    const auto known = bases.emplace(position->second, vertex_count_);
    part.shared = !known.second;
    part.vertex_base = known.first->second;
    if (!part.shared)
        vertex_count_ += vertices;
    /* Stops here, so that the sums cannot overflow, however many nodes there are. */
    if (triangle_count_ > INT32_MAX || vertex_count_ > UINT32_MAX)
        fail(BB_REFUSED, "%s: has more than 2^31 - 1 triangles or 2^32 - 1 vertices", path_);
    parts_.push_back(part);
}

void Loader::plan()
{
    placement_ = place_nodes(path_, model_);
    for (const int node : placement_.order) {
        const int mesh = model_.nodes[static_cast<size_t>(node)].mesh;
        if (mesh < 0)
            continue;
        std::map<int, uint64_t> bases;
        const size_t count = model_.meshes[static_cast<size_t>(mesh)].primitives.size();
        for (size_t i = 0; i < count; i++)
            plan_part({node, mesh, static_cast<int>(i), 0, false, 0}, bases);
    }
    if (triangle_count_ > 0)
        return;
    if (ignored() == 0)
        fail(BB_INVALID, "%s: holds no triangles: no node of its scenes has a mesh", path_);
    fail(BB_INVALID,
         "%s: holds no triangles: of the primitives in its scenes, %llu are points or lines and "
         "%llu lack positions",
         path_, static_cast<unsigned long long>(no_surface_),
         static_cast<unsigned long long>(no_positions_));
}

/* ---- second pass: fill ---- */

/* Rounds once; the identity keeps every bit. */
void transform_point(const Transform &t, const double p[3], float out[3])
{
    for (int row = 0; row < 3; row++) {
        const double *m = t.m[row];
        out[row] = static_cast<float>(t.identity ? p[row]
                                                 : m[0] * p[0] + m[1] * p[1] + m[2] * p[2] + m[3]);
    }
}

void Loader::fill_positions(const Part &part, int accessor, float *vertices) const
{
    const std::string what = name_of(part);
    const Transform &t = placement_.transform[static_cast<size_t>(part.node)];
    accessors_.read_positions(accessor, what + ", POSITION", [&](uint64_t vertex, const double *p) {
        float *out = vertices + 3 * (part.vertex_base + vertex);
        transform_point(t, p, out);
        if (!std::isfinite(out[0]) || !std::isfinite(out[1]) || !std::isfinite(out[2]))
            fail(BB_INVALID,
                 "%s: %s: vertex %llu is not finite: (%g %g %g) in the file, (%g %g %g) in the "
                 "scene",
                 path_, what.c_str(), static_cast<unsigned long long>(vertex), p[0], p[1], p[2],
                 static_cast<double>(out[0]), static_cast<double>(out[1]),
                 static_cast<double>(out[2]));
    });
}

/* Section 3.7.2.1: list {3i, 3i+1, 3i+2}; strip {i, i + (1 + i % 2), i + (2 - i % 2)}; fan {i+1,
 * i+2, 0}. */
void Loader::fill_triangles(const Part &part, uint64_t vertex_count, int accessor, int mode,
                            uint32_t *out) const
{
    const std::string what = name_of(part);
    std::vector<uint32_t> indices;
    if (accessor >= 0)
        indices = accessors_.read_indices(accessor, what + ", indices");
    for (size_t i = 0; i < indices.size(); i++)
        if (indices[i] >= vertex_count)
            fail(BB_INVALID, "%s: %s: index %zu is %u, but there are %llu vertices", path_,
                 what.c_str(), i, indices[i], static_cast<unsigned long long>(vertex_count));
    const uint64_t corners = accessor >= 0 ? indices.size() : vertex_count;
    const uint64_t count = triangles_of(mode, corners, what);
    for (uint64_t i = 0; i < count; i++) {
        uint64_t corner[3] = {3 * i, 3 * i + 1, 3 * i + 2};
        if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
            corner[0] = i;
            corner[1] = i + 1 + i % 2;
            corner[2] = i + 2 - i % 2;
        } else if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
            corner[0] = i + 1;
            corner[1] = i + 2;
            corner[2] = 0;
        }
        for (int k = 0; k < 3; k++)
            out[3 * i + static_cast<uint64_t>(k)] = static_cast<uint32_t>(
                part.vertex_base + (accessor >= 0 ? indices[corner[k]] : corner[k]));
    }
}

void Loader::fill(float *vertices, uint32_t *triangles) const
{
    for (const Part &part : parts_) {
        const tinygltf::Primitive &primitive = model_.meshes[static_cast<size_t>(part.mesh)]
                                                   .primitives[static_cast<size_t>(part.primitive)];
        const int position = primitive.attributes.at("POSITION");
        if (!part.shared)
            fill_positions(part, position, vertices);
        fill_triangles(part, model_.accessors[static_cast<size_t>(position)].count,
                       primitive.indices, primitive.mode, triangles + 3 * part.triangle_base);
    }
}
} // namespace
} // namespace bb_gltf

extern "C" bb_status bb_gltf_load(const char *path, bb_gltf_reserve reserve,
                                  bb_gltf_add_view add_view, void *user, uint32_t *ignored)
{
    try {
        const bb_gltf::Document document = bb_gltf::read_document(path);
        bb_gltf::Loader loader(path, document);
        loader.plan();
        float *vertices = nullptr;
        uint32_t *triangles = nullptr;
        const bb_status status =
            reserve(user, loader.vertex_count(), loader.triangle_count(), &vertices, &triangles);
        if (status != BB_OK)
            return status;
        loader.fill(vertices, triangles);
        *ignored = loader.ignored();
        for (const bb_gltf::NamedView &one : bb_gltf::find_views(document, loader.placement()))
            add_view(user, one.name.c_str(), &one.view);
        return BB_OK;
    } catch (const bb_gltf::Failure &failure) {
        return failure.status;
    } catch (const std::bad_alloc &) {
        return bb_fail(BB_REFUSED, "%s: needs more memory than there is", path);
    } catch (const std::exception &error) {
        return bb_fail(BB_INVALID, "%s: cannot be read: %s", path, error.what());
    }
}
