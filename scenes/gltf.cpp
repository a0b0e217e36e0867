/* The triangles of a glTF 2.0 model (specification sections 3.5 to 3.7): nodes with their
 * transforms, accessors with stride and sparse parts, lists, strips and fans. The model comes from
 * tinygltf, out of a document that gltf_json.cpp has checked; what depends on more than one member
 * (bounds of accessors, index ranges, the node graph) is checked here.
 *
 * Two passes: the first counts, so that all memory is asked for once and refused beforehand; the
 * second fills.
 */
#include "scenes/gltf_nodes.hpp"
#include "scenes/gltf_parts.hpp"

extern "C" {
#include "scenes/gltf.h"
}

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <new>

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "glTF data is read as it lies");

namespace bb_gltf
{
namespace
{
constexpr uint64_t dataless_limit = 1u << 24; /* elements of an accessor that has no data at all */

/* One primitive of one node, with its place in the scene. */
struct Part {
    int node;
    int mesh;
    int primitive;
    uint64_t vertex_base;
    bool shared; /* an earlier part of this node has put the same positions there */
    uint64_t triangle_base;
};

/* The elements of an accessor where they lie; data NULL: all zero. */
struct Elements {
    const unsigned char *data;
    uint64_t count;
    uint64_t stride;
    int component; /* TINYGLTF_COMPONENT_TYPE_... */
};

class Loader
{
  public:
    Loader(const char *path, bool quantised) : path_(path), quantised_(quantised)
    {
    }

    void read(Document &&document);
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
        return static_cast<uint32_t>(std::min<uint64_t>(ignored_, UINT32_MAX));
    }

  private:
    std::string name_of(const Part &part) const;
    void plan_part(const Part &part, std::map<int, uint64_t> &bases);
    const unsigned char *view_bytes(int view, uint64_t offset, uint64_t count, uint64_t element,
                                    uint64_t *stride, const std::string &what) const;
    Elements elements(int accessor, const std::string &what) const;
    void check_positions(int accessor, const std::string &what) const;
    void check_indices(int accessor, const std::string &what) const;
    uint64_t triangles_of(int mode, uint64_t corners, const std::string &what) const;
    std::vector<uint32_t> sparse_indices(const tinygltf::Accessor &accessor,
                                         const std::string &what) const;
    void fill_positions(const Part &part, int accessor, float *vertices) const;
    std::vector<uint32_t> read_indices(int accessor, const std::string &what) const;
    void fill_triangles(const Part &part, uint64_t vertex_count, int accessor, int mode,
                        uint32_t *out) const;

    const char *path_;
    const bool quantised_;
    tinygltf::Model model_;
    std::vector<Buffer> buffers_;
    Placement placement_;
    std::vector<Part> parts_;
    uint64_t vertex_count_ = 0;
    uint64_t triangle_count_ = 0;
    uint64_t ignored_ = 0;
};

/* ---- the model ---- */

void Loader::read(Document &&document)
{
    buffers_ = std::move(document.buffers);
    if (document.json.size() > INT32_MAX)
        fail(BB_REFUSED, "%s: its JSON is larger than 2 GiB", path_);

    tinygltf::TinyGLTF parser;
    std::string error, warning;
    if (!parser.LoadASCIIFromString(&model_, &error, &warning, document.json.data(),
                                    static_cast<unsigned>(document.json.size()), ""))
        fail(BB_INVALID, "%s: tinygltf cannot read it: %s", path_, error.c_str());
}

std::string Loader::name_of(const Part &part) const
{
    const std::string &name = model_.meshes[static_cast<size_t>(part.mesh)].name;
    return "mesh " + std::to_string(part.mesh) +
           (name.empty() ? "" : " (" + name.substr(0, 80) + ")") + ", primitive " +
           std::to_string(part.primitive);
}

/* ---- accessors ---- */

uint64_t component_bytes(int component)
{
    switch (component) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return 2;
    default:
        return 4;
    }
}

/* Where `count` elements of `element` bytes lie, checked against view and buffer without overflow.
 */
const unsigned char *Loader::view_bytes(int number, uint64_t offset, uint64_t count,
                                        uint64_t element, uint64_t *stride,
                                        const std::string &what) const
{
    const tinygltf::BufferView &view = model_.bufferViews[static_cast<size_t>(number)];
    const size_t owner = static_cast<size_t>(view.buffer);
    const Buffer &buffer = buffers_[owner];
    if (!buffer.data)
        fail(BB_INVALID, "%s: %s: buffer %zu has no data", path_, what.c_str(), owner);
    if (view.byteOffset > buffer.size || view.byteLength > buffer.size - view.byteOffset)
        fail(BB_INVALID, "%s: %s: bufferView %d reaches beyond the %llu bytes of buffer %zu", path_,
             what.c_str(), number, static_cast<unsigned long long>(buffer.size), owner);
    *stride = view.byteStride != 0 ? view.byteStride : element;
    if (*stride < element)
        fail(BB_INVALID, "%s: %s: byteStride is %zu, its elements have %llu bytes", path_,
             what.c_str(), view.byteStride, static_cast<unsigned long long>(element));
    if (offset > view.byteLength || element > view.byteLength - offset ||
        count - 1 > (view.byteLength - offset - element) / *stride)
        fail(BB_INVALID, "%s: %s: its %llu elements reach beyond the %zu bytes of bufferView %d",
             path_, what.c_str(), static_cast<unsigned long long>(count), view.byteLength, number);
    return buffer.data.get() + view.byteOffset + offset;
}

Elements Loader::elements(int number, const std::string &what) const
{
    const tinygltf::Accessor &accessor = model_.accessors[static_cast<size_t>(number)];
    const uint64_t element =
        component_bytes(accessor.componentType) * (accessor.type == TINYGLTF_TYPE_VEC3 ? 3 : 1);
    Elements out{nullptr, accessor.count, element, accessor.componentType};
    if (accessor.bufferView >= 0)
        out.data = view_bytes(accessor.bufferView, accessor.byteOffset, accessor.count, element,
                              &out.stride, what);
    else if (accessor.count > dataless_limit)
        fail(BB_REFUSED, "%s: %s: has %zu elements and no data", path_, what.c_str(),
             accessor.count);
    if (accessor.sparse.isSparse && static_cast<uint64_t>(accessor.sparse.count) > accessor.count)
        fail(BB_INVALID, "%s: %s: replaces %d of its %zu elements", path_, what.c_str(),
             accessor.sparse.count, accessor.count);
    return out;
}

void Loader::check_positions(int number, const std::string &what) const
{
    const tinygltf::Accessor &accessor = model_.accessors[static_cast<size_t>(number)];
    const int type = accessor.componentType;
    const bool is_float = type == TINYGLTF_COMPONENT_TYPE_FLOAT;
    const bool is_small =
        type >= TINYGLTF_COMPONENT_TYPE_BYTE && type <= TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    if (accessor.type != TINYGLTF_TYPE_VEC3 || !(is_float || (is_small && quantised_)))
        fail(BB_INVALID,
             "%s: %s: positions must be VEC3 of float (or of 8 or 16 bits with "
             "KHR_mesh_quantization)",
             path_, what.c_str());
    if (is_float && accessor.normalized)
        fail(BB_INVALID, "%s: %s: float positions cannot be normalized", path_, what.c_str());
    elements(number, what);
}

bool is_index_type(int component)
{
    return component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
           component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
           component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

void Loader::check_indices(int number, const std::string &what) const
{
    const tinygltf::Accessor &accessor = model_.accessors[static_cast<size_t>(number)];
    if (accessor.type != TINYGLTF_TYPE_SCALAR || !is_index_type(accessor.componentType) ||
        accessor.normalized)
        fail(BB_INVALID, "%s: %s: indices must be SCALAR of unsigned 8, 16 or 32 bits", path_,
             what.c_str());
    elements(number, what);
}

uint32_t read_unsigned(const unsigned char *at, int component)
{
    if (component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE)
        return *at;
    uint16_t half;
    uint32_t word;
    if (component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) {
        memcpy(&half, at, sizeof half);
        return half;
    }
    memcpy(&word, at, sizeof word);
    return word;
}

/* Integers as KHR_mesh_quantization reads them: c, or c over the largest value, not below -1. */
double read_number(const unsigned char *at, int component, bool normalised)
{
    double value, largest;
    if (component == TINYGLTF_COMPONENT_TYPE_FLOAT) {
        float number;
        memcpy(&number, at, sizeof number);
        return static_cast<double>(number);
    }
    if (component == TINYGLTF_COMPONENT_TYPE_BYTE) {
        value = static_cast<signed char>(*at);
        largest = INT8_MAX;
    } else if (component == TINYGLTF_COMPONENT_TYPE_SHORT) {
        int16_t number;
        memcpy(&number, at, sizeof number);
        value = number;
        largest = INT16_MAX;
    } else {
        value = read_unsigned(at, component);
        largest = component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ? UINT8_MAX : UINT16_MAX;
    }
    return normalised ? std::max(value / largest, -1.0) : value;
}

/* The elements that the sparse part replaces: strictly rising, in range. */
std::vector<uint32_t> Loader::sparse_indices(const tinygltf::Accessor &accessor,
                                             const std::string &what) const
{
    std::vector<uint32_t> out;
    if (!accessor.sparse.isSparse)
        return out;
    const int component = accessor.sparse.indices.componentType;
    if (!is_index_type(component))
        fail(BB_INVALID, "%s: %s: sparse indices must be unsigned, of 8, 16 or 32 bits", path_,
             what.c_str());
    const uint64_t count = static_cast<uint64_t>(accessor.sparse.count);
    uint64_t stride;
    const unsigned char *at =
        view_bytes(accessor.sparse.indices.bufferView,
                   static_cast<uint64_t>(accessor.sparse.indices.byteOffset), count,
                   component_bytes(component), &stride, what + ", sparse indices");
    out.reserve(count);
    for (uint64_t i = 0; i < count; i++) {
        const uint32_t index = read_unsigned(at + i * stride, component);
        if (index >= accessor.count || (i > 0 && index <= out.back()))
            fail(BB_INVALID, "%s: %s: sparse index %llu is %u: must rise and stay below %zu", path_,
                 what.c_str(), static_cast<unsigned long long>(i), index, accessor.count);
        out.push_back(index);
    }
    return out;
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
    const auto indices = primitive.attributes.find(index_attribute);
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES || position == primitive.attributes.end()) {
        ignored_++;
        return;
    }
    const std::string what = name_of(part);
    check_positions(position->second, what + ", POSITION");
    const uint64_t vertices = model_.accessors[static_cast<size_t>(position->second)].count;
    uint64_t corners = vertices;
    if (indices != primitive.attributes.end()) {
        check_indices(indices->second, what + ", indices");
        corners = model_.accessors[static_cast<size_t>(indices->second)].count;
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
    if (triangle_count_ == 0)
        fail(BB_INVALID, "%s: has no triangle in its scenes (%llu primitives of other kinds)",
             path_, static_cast<unsigned long long>(ignored_));
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

void Loader::fill_positions(const Part &part, int number, float *vertices) const
{
    const tinygltf::Accessor &accessor = model_.accessors[static_cast<size_t>(number)];
    const std::string what = name_of(part);
    const Elements from = elements(number, what);
    const Transform &t = placement_.transform[static_cast<size_t>(part.node)];
    const uint64_t size = component_bytes(from.component);
    const auto put = [&](uint64_t vertex, const unsigned char *at) {
        double p[3] = {0, 0, 0};
        for (int axis = 0; axis < 3 && at != nullptr; axis++)
            p[axis] = read_number(at + static_cast<uint64_t>(axis) * size, from.component,
                                  accessor.normalized);
        float *out = vertices + 3 * (part.vertex_base + vertex);
        transform_point(t, p, out);
        if (!std::isfinite(out[0]) || !std::isfinite(out[1]) || !std::isfinite(out[2]))
            fail(BB_INVALID,
                 "%s: %s: vertex %llu is not finite: (%g %g %g) in the file, (%g %g %g) in the "
                 "scene",
                 path_, what.c_str(), static_cast<unsigned long long>(vertex), p[0], p[1], p[2],
                 static_cast<double>(out[0]), static_cast<double>(out[1]),
                 static_cast<double>(out[2]));
    };
    const std::vector<uint32_t> replaced = sparse_indices(accessor, what + ", POSITION");
    size_t next = 0;
    for (uint64_t vertex = 0; vertex < from.count; vertex++) {
        if (next < replaced.size() && replaced[next] == vertex)
            next++; /* a replaced element counts with its new value only */
        else
            put(vertex, from.data != nullptr ? from.data + vertex * from.stride : nullptr);
    }
    if (replaced.empty())
        return;
    uint64_t stride;
    const unsigned char *values = view_bytes(
        accessor.sparse.values.bufferView, static_cast<uint64_t>(accessor.sparse.values.byteOffset),
        replaced.size(), 3 * size, &stride, what + ", POSITION, sparse values");
    for (size_t i = 0; i < replaced.size(); i++)
        put(replaced[i], values + i * stride);
}

std::vector<uint32_t> Loader::read_indices(int number, const std::string &what) const
{
    const tinygltf::Accessor &accessor = model_.accessors[static_cast<size_t>(number)];
    const Elements from = elements(number, what);
    std::vector<uint32_t> out(from.count, 0);
    for (uint64_t i = 0; i < from.count && from.data != nullptr; i++)
        out[i] = read_unsigned(from.data + i * from.stride, from.component);
    const std::vector<uint32_t> replaced = sparse_indices(accessor, what + ", indices");
    if (replaced.empty())
        return out;
    uint64_t stride;
    const unsigned char *values =
        view_bytes(accessor.sparse.values.bufferView,
                   static_cast<uint64_t>(accessor.sparse.values.byteOffset), replaced.size(),
                   component_bytes(from.component), &stride, what + ", indices, sparse values");
    for (size_t i = 0; i < replaced.size(); i++)
        out[replaced[i]] = read_unsigned(values + i * stride, from.component);
    return out;
}

/* Section 3.7.2.1: list {3i, 3i+1, 3i+2}; strip {i, i + (1 + i % 2), i + (2 - i % 2)}; fan {i+1,
 * i+2, 0}. */
void Loader::fill_triangles(const Part &part, uint64_t vertex_count, int accessor, int mode,
                            uint32_t *out) const
{
    const std::string what = name_of(part);
    std::vector<uint32_t> indices;
    if (accessor >= 0)
        indices = read_indices(accessor, what);
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
        const auto indices = primitive.attributes.find(index_attribute);
        if (!part.shared)
            fill_positions(part, position, vertices);
        fill_triangles(part, model_.accessors[static_cast<size_t>(position)].count,
                       indices != primitive.attributes.end() ? indices->second : -1, primitive.mode,
                       triangles + 3 * part.triangle_base);
    }
}
} // namespace
} // namespace bb_gltf

extern "C" bb_status bb_gltf_load(const char *path, bb_gltf_reserve reserve, void *user,
                                  uint32_t *ignored)
{
    try {
        bb_gltf::Document document = bb_gltf::read_document(path);
        bb_gltf::Loader loader(path, document.quantised);
        loader.read(std::move(document));
        loader.plan();
        float *vertices = nullptr;
        uint32_t *triangles = nullptr;
        const bb_status status =
            reserve(user, loader.vertex_count(), loader.triangle_count(), &vertices, &triangles);
        if (status != BB_OK)
            return status;
        loader.fill(vertices, triangles);
        *ignored = loader.ignored();
        return BB_OK;
    } catch (const bb_gltf::Failure &failure) {
        return failure.status;
    } catch (const std::bad_alloc &) {
        return bb_fail(BB_REFUSED, "%s: needs more memory than there is", path);
    } catch (const std::exception &error) {
        return bb_fail(BB_INVALID, "%s: cannot be read: %s", path, error.what());
    }
}
