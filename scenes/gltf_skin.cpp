/* Skins (glTF 2.0 specification, section 3.7.3): a vertex is the weighted mean of the positions to
 * which its joints take it. The transform of the mesh's own node is ignored. */
#include "scenes/gltf_skin.hpp"

#include <cmath>

namespace bb_gltf
{
namespace
{
/* Tolerates rounding in the file's last row, which is not used. */
void check_matrix(const char *path, const std::string &what, uint64_t joint, const double *m)
{
    const double last[4] = {m[3], m[7], m[11], m[15] - 1};
    bool affine = true;
    for (int i = 0; i < 16; i++)
        if (!std::isfinite(m[i]))
            fail(BB_INVALID, "%s: %s: the matrix of joint %llu is not finite", path, what.c_str(),
                 static_cast<unsigned long long>(joint));
    for (const double part : last)
        affine = affine && std::fabs(part) < 1e-3;
    if (!affine)
        fail(BB_INVALID, "%s: %s: the last row of the matrix of joint %llu is not 0 0 0 1", path,
             what.c_str(), static_cast<unsigned long long>(joint));
}
} // namespace

Joints read_joints(const char *path, int skin, const Document &document, const Accessors &accessors,
                   const Placement &placement)
{
    const Skin &from = document.moving->skins[static_cast<size_t>(skin)];
    const std::string what = "skin " + std::to_string(skin);
    const size_t count = from.joints.size();
    Joints out = {from.joints, std::vector<Transform>(count, no_transform)};
    if (count == 0)
        fail(BB_INVALID, "%s: %s has no joints", path, what.c_str());
    for (size_t i = 0; i < count; i++)
        if (!placement.placed[static_cast<size_t>(from.joints[i])])
            fail(BB_INVALID, "%s: %s: its joint %zu is node %d, which is in no scene", path,
                 what.c_str(), i, from.joints[i]);
    if (from.inverse_bind < 0)
        return out;
    const std::string matrices = what + ", inverseBindMatrices";
    accessors.check_numbers(from.inverse_bind, matrices, TINYGLTF_TYPE_MAT4, Accessors::floats,
                            "MAT4 of float");
    if (accessors.count(from.inverse_bind) < count)
        fail(BB_INVALID, "%s: %s: has %llu matrices for %zu joints", path, matrices.c_str(),
             static_cast<unsigned long long>(accessors.count(from.inverse_bind)), count);
    accessors.read_numbers(from.inverse_bind, matrices, [&](uint64_t joint, const double *m) {
        if (joint >= count)
            return;
        check_matrix(path, what, joint, m);
        out.inverse_bind[joint] = from_columns(m);
    });
    return out;
}

std::vector<Transform> place_joints(const Joints &joints, const Placement &placement)
{
    std::vector<Transform> out;
    out.reserve(joints.nodes.size());
    for (size_t i = 0; i < joints.nodes.size(); i++)
        out.push_back(multiply(placement.transform[static_cast<size_t>(joints.nodes[i])],
                               joints.inverse_bind[i]));
    return out;
}

/* ---- the joints of vertices ---- */

uint64_t bytes_of_influences(const Deformers &deformers, uint64_t vertices)
{
    return vertices *
           (sizeof(uint64_t) + deformers.joints.size() * 4 *
                                   (sizeof(double) + sizeof(uint32_t) + sizeof(Influences::One)));
}

namespace
{
/* Joints and weights as in the file, four per set. */
struct Table {
    std::vector<uint32_t> joints;
    std::vector<double> weights;
};

Table read_table(const char *path, const std::string &what, const Accessors &accessors,
                 const Deformers &deformers, uint64_t vertices)
{
    const size_t sets = deformers.joints.size();
    Table out = {std::vector<uint32_t>(4 * sets * vertices),
                 std::vector<double>(4 * sets * vertices)};
    for (size_t set = 0; set < sets; set++) {
        const std::string number = std::to_string(set);
        const std::string joints = what + ", JOINTS_" + number;
        const std::string weights = what + ", WEIGHTS_" + number;
        accessors.check_numbers(deformers.joints[set], joints, TINYGLTF_TYPE_VEC4,
                                Accessors::whole_numbers, "VEC4 of unsigned 8 or 16 bits");
        accessors.check_numbers(deformers.weights[set], weights, TINYGLTF_TYPE_VEC4,
                                Accessors::floats | Accessors::unsigned_fractions,
                                "VEC4 of float or normalized unsigned integers");
        for (const int accessor : {deformers.joints[set], deformers.weights[set]})
            if (accessors.count(accessor) != vertices)
                fail(BB_INVALID, "%s: %s: accessor %d has %llu elements for %llu vertices", path,
                     joints.c_str(), accessor,
                     static_cast<unsigned long long>(accessors.count(accessor)),
                     static_cast<unsigned long long>(vertices));
        const auto at = [&](uint64_t vertex) { return 4 * (vertex * sets + set); };
        accessors.read_numbers(deformers.joints[set], joints, [&](uint64_t v, const double *four) {
            for (size_t i = 0; i < 4; i++)
                out.joints[at(v) + i] = static_cast<uint32_t>(four[i]);
        });
        accessors.read_numbers(deformers.weights[set], weights,
                               [&](uint64_t v, const double *four) {
                                   std::copy(four, four + 4, &out.weights[at(v)]);
                               });
    }
    return out;
}
} // namespace

Influences read_influences(const char *path, const std::string &what, const Accessors &accessors,
                           const Deformers &deformers, uint64_t vertices, size_t joints)
{
    const Table table = read_table(path, what, accessors, deformers, vertices);
    const size_t per_vertex = 4 * deformers.joints.size();
    Influences out;
    out.ends.reserve(vertices);
    for (uint64_t vertex = 0; vertex < vertices; vertex++) {
        const size_t first = out.list.size();
        double sum = 0;
        for (size_t i = vertex * per_vertex; i < (vertex + 1) * per_vertex; i++) {
            const double weight = table.weights[i];
            if (!(weight >= 0) || !std::isfinite(weight))
                fail(BB_INVALID, "%s: %s: vertex %llu has a weight of %g: must be 0 or more", path,
                     what.c_str(), static_cast<unsigned long long>(vertex), weight);
            if (weight > 0 && table.joints[i] >= joints)
                fail(BB_INVALID, "%s: %s: vertex %llu follows joint %u, but its skin has %zu", path,
                     what.c_str(), static_cast<unsigned long long>(vertex), table.joints[i],
                     joints);
            sum += weight;
            if (weight > 0)
                out.list.push_back({weight, table.joints[i]});
        }
        for (size_t i = first; i < out.list.size(); i++)
            out.list[i].weight /= sum;
        out.ends.push_back(out.list.size());
    }
    return out;
}

void skin_points(const Influences &influences, const std::vector<Transform> &joints,
                 std::vector<double> &points)
{
    uint64_t at = 0;
    for (size_t vertex = 0; vertex < influences.ends.size(); vertex++) {
        double *p = &points[3 * vertex], sum[3] = {0, 0, 0}, moved[3];
        if (at == influences.ends[vertex])
            continue;
        for (; at < influences.ends[vertex]; at++) {
            const Influences::One &one = influences.list[at];
            transform_point(joints[one.joint], p, moved);
            for (int axis = 0; axis < 3; axis++)
                sum[axis] += one.weight * moved[axis];
        }
        std::copy(sum, sum + 3, p);
    }
}
} // namespace bb_gltf
