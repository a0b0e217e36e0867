/* What the parts of the glTF loader share: gltf_json.cpp gets the model from tinygltf, after
 * gltf_schema.cpp has checked it; gltf_buffers.cpp reads files; gltf_plan.cpp takes the triangles,
 * gltf_cameras.cpp the cameras, gltf_moving.cpp and gltf_pose.cpp what moves them. */
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
/* Thrown after bb_fail() has the message; caught at the C door. */
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

/* What the document says of a buffer. */
struct BufferRequest {
    std::string where;      /* names it in messages */
    uint64_t length;        /* byteLength */
    const std::string *uri; /* NULL: it has none, and is `chunk` */
    Buffer chunk;           /* the BIN chunk, or a placeholder */
};

/* The whole of a file. Refused if it does not fit into the host's memory. */
Buffer read_file(const std::string &path);

/* byteLength bytes of each buffer of the glTF file at `path`, which has `file_size` bytes
 * itself. Refused are uris that are no data and name no file below the folder of `path`, what is
 * shorter than its byteLength, and what does not fit into the host's memory together. */
std::vector<Buffer> read_buffers(const std::string &path, uint64_t file_size,
                                 const std::vector<BufferRequest> &requests);

struct Camera {
    std::string name;
    bool parallel;
    double extent; /* as bb_view's fov_y; not checked */
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

/* What a primitive has for being moved: accessors. */
struct Deformers {
    std::vector<int> targets;         /* of POSITION; -1: the target moves no positions */
    std::vector<int> joints, weights; /* JOINTS_0, WEIGHTS_0 and on, as many of each */
};

struct MeshDeformers {
    std::vector<Deformers> primitives;
    size_t target_count;         /* of each primitive */
    std::vector<double> weights; /* as many, or none */
};

/* Of nodes that have any: weights in place of the mesh's, a skin or -1. */
struct NodeDeformers {
    std::vector<double> weights;
    int skin = -1;
};

struct Moving {
    std::string clip; /* names it in messages */
    std::vector<Channel> channels;
    uint64_t ignored = 0; /* channels of no node, or of a path that is not known */
    std::vector<Skin> skins;
    std::vector<MeshDeformers> meshes;
    std::vector<NodeDeformers> nodes;
};

/* ---- the document ---- */

/* A checked file: members are of the right type and references in range. The model holds only
 * what the triangles need; its buffers are here. */
struct Document {
    tinygltf::Model model;
    std::vector<Buffer> buffers;
    std::map<int, Camera> cameras; /* by node */
    std::optional<Moving> moving;  /* of the clip that was asked for */
    bool quantised = false; /* KHR_mesh_quantization is used: integer positions are allowed */
};

/* Fails on what tinygltf would misunderstand. */
void check_schema(const char *path, const nlohmann::json &root);
/* The same, of animations, skins and morph targets. */
void check_moving_schema(const char *path, const nlohmann::json &root);

std::map<int, Camera> find_cameras(const nlohmann::json &root);

/* Of the animation that `clip` names, by its name or, if it is made of digits, its number. `root`
 * has passed check_schema() and check_moving_schema(). Fails if there is no such animation, or if
 * it moves no node. */
Moving find_moving(const char *path, const nlohmann::json &root, const std::string &clip);

/* Reads and checks `path`, .gltf or .glb by content. `clip` names an animation; NULL: none is
 * looked at. */
Document read_document(const std::string &path, const char *clip);

struct NamedView {
    std::string name;
    bb_view view; /* but for its name */
};

/* The cameras of the default scene's nodes, in the order of the nodes. */
struct Placement;
std::vector<NamedView> find_views(const Document &document, const Placement &placement);
} // namespace bb_gltf

#endif
