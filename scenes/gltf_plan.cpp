/* The triangles of a glTF model (specification sections 3.5 to 3.7): lists, strips and fans of the
 * placed nodes. */
#include "scenes/gltf_plan.hpp"

#include <cmath>

namespace bb_gltf
{
Plan::Plan(const char *path, const Document &document, const Accessors &accessors,
           const Placement &placement)
    : path_(path), document_(document), model_(document.model), accessors_(accessors),
      placement_(placement)
{
    for (const int node : placement_.order) {
        const int mesh = model_.nodes[static_cast<size_t>(node)].mesh;
        if (mesh < 0)
            continue;
        Bases bases;
        const size_t count = model_.meshes[static_cast<size_t>(mesh)].primitives.size();
        for (size_t i = 0; i < count; i++)
            plan_part({node, mesh, static_cast<int>(i), -1, 0, false, 0}, bases);
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

std::string Plan::name_of(const Part &part) const
{
    const std::string &name = model_.meshes[static_cast<size_t>(part.mesh)].name;
    return "mesh " + std::to_string(part.mesh) +
           (name.empty() ? "" : " (" + name.substr(0, 80) + ")") + ", primitive " +
           std::to_string(part.primitive);
}

const tinygltf::Primitive &Plan::primitive_of(const Part &part) const
{
    return model_.meshes[static_cast<size_t>(part.mesh)]
        .primitives[static_cast<size_t>(part.primitive)];
}

/* ---- first pass: count ---- */

uint64_t Plan::triangles_of(int mode, uint64_t corners, const std::string &what) const
{
    if (corners < 3 || (mode == TINYGLTF_MODE_TRIANGLES && corners % 3 != 0))
        fail(BB_INVALID, "%s: %s: %llu corners make no whole number of triangles", path_,
             what.c_str(), static_cast<unsigned long long>(corners));
    return mode == TINYGLTF_MODE_TRIANGLES ? corners / 3 : corners - 2;
}

/* Returns what distinguishes the vertices of the primitives of a node: everything their positions
 * depend on. */
std::vector<int> Plan::vertices_of(const Part &part) const
{
    std::vector<int> key = {part.positions};
    if (!document_.moving)
        return key;
    const Deformers &deformers = document_.moving->meshes[static_cast<size_t>(part.mesh)]
                                     .primitives[static_cast<size_t>(part.primitive)];
    for (const std::vector<int> *list : {&deformers.targets, &deformers.joints, &deformers.weights})
        key.insert(key.end(), list->begin(), list->end());
    return key;
}

void Plan::plan_part(const Part &place, Bases &bases)
{
    Part part = place;
    const tinygltf::Primitive &primitive = primitive_of(part);
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
    part.positions = position->second;
    accessors_.check_positions(part.positions, what + ", POSITION");
    const uint64_t vertices = accessors_.count(part.positions);
    uint64_t corners = vertices;
    if (primitive.indices >= 0) {
        accessors_.check_indices(primitive.indices, what + ", indices");
        corners = accessors_.count(primitive.indices);
    }
    part.triangle_base = triangle_count_;
    triangle_count_ += triangles_of(primitive.mode, corners, what);
    const auto known = bases.emplace(vertices_of(part), vertex_count_);
    part.shared = !known.second;
    part.vertex_base = known.first->second;
    if (!part.shared)
        vertex_count_ += vertices;
    /* Stops here, so that the sums cannot overflow, for any number of nodes. */
    if (triangle_count_ > INT32_MAX || vertex_count_ > UINT32_MAX)
        fail(BB_REFUSED, "%s: has more than 2^31 - 1 triangles or 2^32 - 1 vertices", path_);
    parts_.push_back(part);
}

/* ---- second pass: fill ---- */

void Plan::fill_positions(const Part &part, const std::string &what, float *vertices) const
{
    const Transform &t = placement_.transform[static_cast<size_t>(part.node)];
    accessors_.read_numbers(
        part.positions, what + ", POSITION", [&](uint64_t vertex, const double *p) {
            double moved[3];
            float *out = vertices + 3 * (part.vertex_base + vertex);
            transform_point(t, p, moved);
            for (int axis = 0; axis < 3; axis++)
                out[axis] = static_cast<float>(moved[axis]);
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
void Plan::fill_part(const Part &part, uint32_t *out) const
{
    const std::string what = name_of(part);
    const int accessor = primitive_of(part).indices, mode = primitive_of(part).mode;
    const uint64_t vertex_count = accessors_.count(part.positions);
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

void Plan::fill_triangles(uint32_t *triangles) const
{
    for (const Part &part : parts_)
        fill_part(part, triangles + 3 * part.triangle_base);
}
} // namespace bb_gltf
