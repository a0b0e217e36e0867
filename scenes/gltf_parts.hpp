/* Shared by the parts of the glTF loader: gltf_json.cpp gets the model from tinygltf, after
 * gltf_schema.cpp has checked it; gltf_buffers.cpp reads files; gltf_plan.cpp takes the triangles,
 * gltf_cameras.cpp the cameras, gltf_moving.cpp and gltf_pose.cpp the motion. */
#ifndef BB_GLTF_PARTS_HPP
#define BB_GLTF_PARTS_HPP

extern "C" {
#include "framework/scene/scene.h"
}

#include <nlohmann/json_fwd.hpp>
#include <tiny_gltf.h>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace bb_gltf
{
/* Thrown after bb_fail() has the message; caught at the C interface. */
struct Failure {
    bb_status status;
};

[[noreturn]] void fail(bb_status status, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Bytes of a file or a buffer; buffers may share them. A placeholder has none. */
struct Buffer {
    std::shared_ptr<const unsigned char> data;
    uint64_t size = 0;
};

/* A buffer as the document describes it. */
struct BufferRequest {
    std::string where;      /* names it in messages */
    uint64_t length;        /* byteLength */
    const std::string *uri; /* NULL: it has none, and is `chunk` */
    Buffer chunk;           /* the BIN chunk, or a placeholder */
};

/* Reads a whole file. Refused if it does not fit into the host's memory. */
Buffer read_file(const std::string &path);

/* Reads byteLength bytes of each buffer of the glTF file at `path`, which itself has `file_size`
 * bytes. Refused are uris that are neither data nor the name of a file below the folder of `path`,
 * buffers shorter than their byteLength, and buffers that do not fit into the host's memory
 * together. */
std::vector<Buffer> read_buffers(const std::string &path, uint64_t file_size,
                                 const std::vector<BufferRequest> &requests);

struct Camera {
    std::string name;
    bool parallel;
    double extent; /* like bb_view's fov_y; not checked */
};

/* ---- one of the animations, and the skins and morph targets that it moves ---- */

enum class Path { translation, rotation, scale, weights };
enum class Interpolation { step, linear, cubic };

/* Moves one property of a node; `input` and `output` are accessors. */
struct Channel {
    int number; /* in the animation, for messages */
    int node;
    Path path;
    Interpolation interpolation;
    int input, output;
};

struct Skin {
    std::vector<int> joints; /* nodes */
    int inverse_bind;        /* an accessor; -1: identities */
};

/* Accessors of a primitive that can be moved. */
struct Deformers {
    std::vector<int> targets;         /* of POSITION; -1: the target moves no positions */
    std::vector<int> joints, weights; /* JOINTS_0, WEIGHTS_0 and on, as many of each */
};

struct MeshDeformers {
    std::vector<Deformers> primitives;
    size_t target_count;         /* of each primitive */
    std::vector<double> weights; /* as many, or none */
};

/* For nodes that have any: weights that replace the mesh's, a skin or -1. */
struct NodeDeformers {
    std::vector<double> weights;
    int skin = -1;
};

struct Moving {
    std::string clip; /* names it in messages */
    std::vector<Channel> channels;
    uint64_t ignored = 0; /* channels without a node, or with an unknown path */
    std::vector<Skin> skins;
    std::vector<MeshDeformers> meshes;
    std::vector<NodeDeformers> nodes;
};

/* ---- the document ---- */

/* A checked file: members have the right types and references are in range. The model only has what
 * the triangles need; its buffers are here. */
struct Document {
    tinygltf::Model model;
    std::vector<Buffer> buffers;
    std::map<int, Camera> cameras; /* by node */
    std::optional<Moving> moving;  /* of the requested clip */
    bool quantised = false; /* KHR_mesh_quantization is used: integer positions are allowed */
};

/* Fails on members that tinygltf would misunderstand. */
void check_schema(const char *path, const nlohmann::json &root);
/* The same for animations, skins and morph targets. */
void check_moving_schema(const char *path, const nlohmann::json &root);

std::map<int, Camera> find_cameras(const nlohmann::json &root);

/* Finds the animation that `clip` names, by its name or, if it consists of digits, its number.
 * `root` has passed check_schema() and check_moving_schema(). Fails if there is no such animation,
 * or if it moves no node. */
Moving find_moving(const char *path, const nlohmann::json &root, const std::string &clip);

/* Reads and checks `path`, .gltf or .glb by content. `clip` names an animation; NULL: animations
 * are ignored. */
Document read_document(const std::string &path, const char *clip);

struct NamedView {
    std::string name;
    bb_view view; /* without its name */
};

/* Returns the cameras of the default scene's nodes, in the order of the nodes. */
struct Placement;
std::vector<NamedView> find_views(const Document &document, const Placement &placement);
} // namespace bb_gltf

#endif
