/* Accessors of a glTF model (glTF 2.0 specification, section 3.6.2): bounds, stride, sparse parts
 * and component types. tinygltf returns their members and checks none of this. */
#include "scenes/gltf_accessors.hpp"

#include <algorithm>
#include <cstring>

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "glTF data is read as it lies");

namespace bb_gltf
{
namespace
{
constexpr uint64_t dataless_limit = 1u << 24; /* elements of an accessor without any data */

uint64_t bytes_of(int component)
{
    return static_cast<uint64_t>(
        tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(component)));
}

uint64_t numbers_of(int type)
{
    return static_cast<uint64_t>(tinygltf::GetNumComponentsInType(static_cast<uint32_t>(type)));
}

bool is_index_type(int component)
{
    return component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
           component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
           component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
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

/* Reads integers as KHR_mesh_quantization defines: c, or c over the largest value, at least -1. */
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

} // namespace

/* Returns the position of `count` elements of `element` bytes, checked against view and buffer
 * without overflow.
 */
const unsigned char *Accessors::view_bytes(int number, uint64_t offset, uint64_t count,
                                           uint64_t element, uint64_t *stride,
                                           const std::string &what) const
{
    const tinygltf::BufferView &view = document_.model.bufferViews[static_cast<size_t>(number)];
    const size_t owner = static_cast<size_t>(view.buffer);
    const Buffer &buffer = document_.buffers[owner];
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

Accessors::Elements Accessors::elements(int number, const std::string &what) const
{
    const tinygltf::Accessor &accessor = document_.model.accessors[static_cast<size_t>(number)];
    const uint64_t element = bytes_of(accessor.componentType) * numbers_of(accessor.type);
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

void Accessors::check_positions(int number, const std::string &what) const
{
    const tinygltf::Accessor &accessor = document_.model.accessors[static_cast<size_t>(number)];
    const int type = accessor.componentType;
    const bool is_float = type == TINYGLTF_COMPONENT_TYPE_FLOAT;
    const bool is_small =
        type >= TINYGLTF_COMPONENT_TYPE_BYTE && type <= TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    if (accessor.type != TINYGLTF_TYPE_VEC3 || !(is_float || (is_small && document_.quantised)))
        fail(BB_INVALID,
             "%s: %s: positions must be VEC3 of float (or of 8 or 16 bits with "
             "KHR_mesh_quantization)",
             path_, what.c_str());
    if (is_float && accessor.normalized)
        fail(BB_INVALID, "%s: %s: float positions cannot be normalized", path_, what.c_str());
    elements(number, what);
}

void Accessors::check_numbers(int number, const std::string &what, int type, unsigned kinds,
                              const char *must) const
{
    const tinygltf::Accessor &accessor = document_.model.accessors[static_cast<size_t>(number)];
    unsigned kind = 0;
    switch (accessor.componentType) {
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
        kind = accessor.normalized ? 0 : floats;
        break;
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_SHORT:
        kind = accessor.normalized ? signed_fractions : 0;
        break;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        kind = accessor.normalized ? unsigned_fractions : whole_numbers;
        break;
    default:
        break;
    }
    if (accessor.type != type || (kind & kinds) == 0)
        fail(BB_INVALID, "%s: %s: must be %s", path_, what.c_str(), must);
    elements(number, what);
}

uint64_t Accessors::count(int number) const
{
    return document_.model.accessors[static_cast<size_t>(number)].count;
}

uint64_t Accessors::given(int number) const
{
    const tinygltf::Accessor &accessor = document_.model.accessors[static_cast<size_t>(number)];
    const uint64_t sparse =
        accessor.sparse.isSparse ? static_cast<uint64_t>(accessor.sparse.count) : 0;
    return accessor.bufferView >= 0 ? accessor.count : sparse;
}

void Accessors::check_indices(int number, const std::string &what) const
{
    const tinygltf::Accessor &accessor = document_.model.accessors[static_cast<size_t>(number)];
    if (accessor.type != TINYGLTF_TYPE_SCALAR || !is_index_type(accessor.componentType) ||
        accessor.normalized)
        fail(BB_INVALID, "%s: %s: indices must be SCALAR of unsigned 8, 16 or 32 bits", path_,
             what.c_str());
    elements(number, what);
}

/* Returns the elements that the sparse part replaces: strictly increasing, in range. */
std::vector<uint32_t> Accessors::sparse_indices(const tinygltf::Accessor &accessor,
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
                   bytes_of(component), &stride, what + ", sparse indices");
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

void Accessors::read_numbers(int number, const std::string &what, const Put &put) const
{
    const tinygltf::Accessor &accessor = document_.model.accessors[static_cast<size_t>(number)];
    const Elements from = elements(number, what);
    const uint64_t size = bytes_of(from.component), numbers = numbers_of(accessor.type);
    const auto read = [&](uint64_t element, const unsigned char *at) {
        double values[16] = {};
        for (uint64_t i = 0; i < numbers && at != nullptr; i++)
            values[i] = read_number(at + i * size, from.component, accessor.normalized);
        put(element, values);
    };
    const std::vector<uint32_t> replaced = sparse_indices(accessor, what);
    size_t next = 0;
    for (uint64_t element = 0; element < from.count; element++) {
        if (next < replaced.size() && replaced[next] == element)
            next++; /* only the new value of a replaced element counts */
        else
            read(element, from.data != nullptr ? from.data + element * from.stride : nullptr);
    }
    if (replaced.empty())
        return;
    uint64_t stride;
    const unsigned char *values = view_bytes(
        accessor.sparse.values.bufferView, static_cast<uint64_t>(accessor.sparse.values.byteOffset),
        replaced.size(), numbers * size, &stride, what + ", sparse values");
    for (size_t i = 0; i < replaced.size(); i++)
        read(replaced[i], values + i * stride);
}

std::vector<uint32_t> Accessors::read_indices(int number, const std::string &what) const
{
    const tinygltf::Accessor &accessor = document_.model.accessors[static_cast<size_t>(number)];
    const Elements from = elements(number, what);
    std::vector<uint32_t> out(from.count, 0);
    for (uint64_t i = 0; i < from.count && from.data != nullptr; i++)
        out[i] = read_unsigned(from.data + i * from.stride, from.component);
    const std::vector<uint32_t> replaced = sparse_indices(accessor, what);
    if (replaced.empty())
        return out;
    uint64_t stride;
    const unsigned char *values = view_bytes(
        accessor.sparse.values.bufferView, static_cast<uint64_t>(accessor.sparse.values.byteOffset),
        replaced.size(), bytes_of(from.component), &stride, what + ", sparse values");
    for (size_t i = 0; i < replaced.size(); i++)
        out[replaced[i]] = read_unsigned(values + i * stride, from.component);
    return out;
}

} // namespace bb_gltf
