/* What a glTF document says of one of its animations, and of the skins and morph targets that it
 * moves. */
#ifndef BB_GLTF_MOVING_HPP
#define BB_GLTF_MOVING_HPP

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace bb_gltf
{
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

/* Of the animation that `clip` names, by its name or, if it is made of digits, its number. `root`
 * has passed check_schema() and check_moving_schema(). Fails if there is no such animation, or if
 * it moves no node. */
Moving find_moving(const char *path, const nlohmann::json &root, const std::string &clip);
} // namespace bb_gltf

#endif
