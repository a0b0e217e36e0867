/* Skins: vertices that follow several joints, blended linearly. */
#ifndef BB_GLTF_SKIN_HPP
#define BB_GLTF_SKIN_HPP

#include "scenes/gltf_accessors.hpp"
#include "scenes/gltf_nodes.hpp"

namespace bb_gltf
{
/* A skin with its matrices. */
struct Joints {
    std::vector<int> nodes;
    std::vector<Transform> inverse_bind; /* from the mesh to the joint, in the bind pose */
};

/* Fails if a skin has no joints or joints that are in no scene, and if matrices are too few, not
 * finite, or not affine transforms. */
Joints read_joints(const char *path, int skin, const Document &document, const Accessors &accessors,
                   const Placement &placement);

/* Returns the transforms from the mesh to the scene by each joint's current transform. */
std::vector<Transform> place_joints(const Joints &joints, const Placement &placement);

/* The joints that vertices follow, without those of weight 0; the weights of a vertex sum to 1.
 * Vertex i has list[ends[i - 1] .. ends[i] - 1]. */
struct Influences {
    struct One {
        double weight;
        uint32_t joint;
    };
    std::vector<uint64_t> ends;
    std::vector<One> list;
};

/* Returns the most bytes that reading influences takes. */
uint64_t bytes_of_influences(const Deformers &deformers, uint64_t vertices);

/* Fails on joints that the skin does not have, and on negative weights. */
Influences read_influences(const char *path, const std::string &what, const Accessors &accessors,
                           const Deformers &deformers, uint64_t vertices, size_t joints);

/* Moves `points`, x y z of each vertex, from the mesh to the scene. Vertices that follow no joint
 * do not move. */
void skin_points(const Influences &influences, const std::vector<Transform> &joints,
                 std::vector<double> &points);
} // namespace bb_gltf

#endif
