/* What the parts of the glTF loader share: gltf_json.cpp reads and checks the file, gltf.cpp takes
 * the triangles. */
#ifndef BB_GLTF_PARTS_HPP
#define BB_GLTF_PARTS_HPP

extern "C" {
#include "framework/status.h"
}

#include <cstdint>
#include <string>
#include <vector>

namespace bb_gltf
{
/* Thrown after bb_fail() has the message; caught at the C door. */
struct Failure {
    bb_status status;
};

[[noreturn]] void fail(bb_status status, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

using Bytes = std::vector<unsigned char>;

/* A checked file. `json` has only the members that the geometry needs, each of the right type and
 * with references in range; `buffers` has the bytes of each buffer, exactly byteLength of them, or
 * none for a placeholder. */
struct Document {
    std::string json;
    std::vector<Bytes> buffers;
    bool quantised = false; /* KHR_mesh_quantization is used: integer positions are allowed */
};

/* Reads and checks `path`, .gltf or .glb by content. */
Document read_document(const std::string &path);

/* The attribute under which `json` carries a primitive's indices: tinygltf refuses indices without
 * a bufferView (sparse ones may have none), but not attributes. */
constexpr const char *index_attribute = "_INDICES";
} // namespace bb_gltf

#endif
