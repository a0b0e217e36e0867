/* The node graph of a glTF model, flattened. */
#ifndef BB_GLTF_NODES_HPP
#define BB_GLTF_NODES_HPP

#include <vector>

namespace tinygltf
{
class Model;
}

namespace bb_gltf
{
/* Column vectors: p' = m p, m[row][column], the last row being 0 0 0 1. */
struct Transform {
    double m[3][4];
    bool identity;
};

constexpr Transform no_transform = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}, true};

/* Returns a after b. */
Transform multiply(const Transform &a, const Transform &b);
/* Makes a transform from 16 numbers, column by column, whose last row is 0 0 0 1. */
Transform from_columns(const double *m);
/* Does not round to float; the identity keeps every bit. */
void transform_point(const Transform &t, const double p[3], double out[3]);

struct Placement {
    std::vector<int> order;   /* nodes of the scenes, depth first, in the order of the file */
    std::vector<int> parent;  /* of each node of the file; -1: none */
    std::vector<bool> placed; /* whether a node is in a scene */
    std::vector<Transform> transform; /* of each node of the file, to the scene */
};

/* Places the nodes of all scenes, each once; if there is no scene, those of all roots. Fails if the
 * graph is not a forest. */
Placement place_nodes(const char *path, const tinygltf::Model &model);

/* Recomputes the transforms after the model's nodes have moved. */
void place_again(const char *path, const tinygltf::Model &model, Placement &placement);
} // namespace bb_gltf

#endif
