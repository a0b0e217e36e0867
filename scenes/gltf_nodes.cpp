/* Nodes and their transforms (glTF 2.0 specification, section 3.5.3): translation * rotation *
 * scale or a matrix, accumulated in double precision from the roots. Iterative, so that a chain of
 * a million nodes does not overflow the stack. */
#include "scenes/gltf_nodes.hpp"
#include "scenes/gltf_parts.hpp"

#include <tiny_gltf.h>

#include <cmath>

namespace bb_gltf
{
namespace
{
Transform from_rotation(const std::vector<double> &q)
{
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    return {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 0},
             {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), 0},
             {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), 0}},
            false};
}

bool is_identity(const Transform &t)
{
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++)
            if (t.m[row][column] != (row == column ? 1 : 0))
                return false;
    return true;
}

Transform local_transform(const char *path, const tinygltf::Model &model, size_t index)
{
    const tinygltf::Node &node = model.nodes[index];
    Transform t = no_transform;
    if (!node.matrix.empty()) {
        const std::vector<double> &m = node.matrix;
        if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
            fail(BB_INVALID, "%s: node %zu: the last row of its matrix is not 0 0 0 1", path,
                 index);
        t = from_columns(m.data());
    }
    if (!node.rotation.empty()) {
        std::vector<double> q = node.rotation;
        const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        if (!(std::fabs(length - 1) < 0.01))
            fail(BB_INVALID, "%s: node %zu: its rotation is a quaternion of length %g, must be 1",
                 path, index, length);
        for (double &part : q)
            part /= length;
        t = from_rotation(q);
    }
    for (int row = 0; row < 3 && !node.scale.empty(); row++)
        for (int column = 0; column < 3; column++)
            t.m[row][column] *= node.scale[static_cast<size_t>(column)];
    for (int row = 0; row < 3 && !node.translation.empty(); row++)
        t.m[row][3] = node.translation[static_cast<size_t>(row)];
    t.identity = is_identity(t);
    return t;
}

/* The nodes must form a forest, with the roots of the scenes among its roots: a node below two
 * parents would be an instance, which glTF does not have, and could make a small file endless. */
std::vector<int> find_roots(const char *path, const tinygltf::Model &model,
                            std::vector<int> &parent)
{
    const size_t count = model.nodes.size();
    parent.assign(count, -1);
    for (size_t node = 0; node < count; node++)
        for (const int child : model.nodes[node].children) {
            int &known = parent[static_cast<size_t>(child)];
            if (known >= 0)
                fail(BB_INVALID,
                     "%s: node %d is a child of node %d and of node %zu: must be of one", path,
                     child, known, node);
            known = static_cast<int>(node);
        }
    /* With at most one parent each, nodes that no root leads to form a cycle. */
    size_t reached = 0;
    std::vector<int> stack, roots;
    for (size_t node = 0; node < count; node++)
        if (parent[node] < 0)
            stack.push_back(static_cast<int>(node));
    if (model.scenes.empty())
        roots = stack;
    while (!stack.empty()) {
        const size_t node = static_cast<size_t>(stack.back());
        stack.pop_back();
        reached++;
        stack.insert(stack.end(), model.nodes[node].children.begin(),
                     model.nodes[node].children.end());
    }
    if (reached != count)
        fail(BB_INVALID, "%s: its nodes form a cycle: a node is its own ancestor", path);

    std::vector<bool> taken(count, false);
    for (size_t scene = 0; scene < model.scenes.size(); scene++)
        for (const int node : model.scenes[scene].nodes) {
            const size_t index = static_cast<size_t>(node);
            if (parent[index] >= 0)
                fail(BB_INVALID, "%s: node %d is a root of scene %zu, but also a child of node %d",
                     path, node, scene, parent[index]);
            if (!taken[index])
                roots.push_back(node);
            taken[index] = true;
        }
    return roots;
}
} // namespace

Transform multiply(const Transform &a, const Transform &b)
{
    if (a.identity)
        return b;
    if (b.identity)
        return a;
    Transform out;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++)
            out.m[row][column] = a.m[row][0] * b.m[0][column] + a.m[row][1] * b.m[1][column] +
                                 a.m[row][2] * b.m[2][column] + (column == 3 ? a.m[row][3] : 0);
    out.identity = is_identity(out);
    return out;
}

Transform from_columns(const double *m)
{
    Transform t = no_transform;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++)
            t.m[row][column] = m[4 * column + row];
    t.identity = is_identity(t);
    return t;
}

void transform_point(const Transform &t, const double p[3], double out[3])
{
    for (int row = 0; row < 3; row++) {
        const double *m = t.m[row];
        out[row] = t.identity ? p[row] : m[0] * p[0] + m[1] * p[1] + m[2] * p[2] + m[3];
    }
}

Placement place_nodes(const char *path, const tinygltf::Model &model)
{
    Placement out;
    const std::vector<int> roots = find_roots(path, model, out.parent);
    out.transform.assign(model.nodes.size(), no_transform);
    out.placed.assign(model.nodes.size(), false);
    std::vector<int> stack(roots.rbegin(), roots.rend());
    while (!stack.empty()) {
        const size_t node = static_cast<size_t>(stack.back());
        stack.pop_back();
        out.order.push_back(static_cast<int>(node));
        out.placed[node] = true;
        const std::vector<int> &children = model.nodes[node].children;
        stack.insert(stack.end(), children.rbegin(), children.rend());
    }
    place_again(path, model, out);
    return out;
}

/* Parents precede their children. */
void place_again(const char *path, const tinygltf::Model &model, Placement &placement)
{
    for (const int node : placement.order) {
        const size_t index = static_cast<size_t>(node);
        const int parent = placement.parent[index];
        const Transform &above =
            parent >= 0 ? placement.transform[static_cast<size_t>(parent)] : no_transform;
        placement.transform[index] = multiply(above, local_transform(path, model, index));
    }
}
} // namespace bb_gltf
