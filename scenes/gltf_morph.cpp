/* Morph targets (glTF 2.0 specification, section 3.7.2.2): a vertex's position plus the sum of its
 * displacements times their weights. */
#include "scenes/gltf_morph.hpp"

#include <cmath>

namespace bb_gltf
{
namespace
{
std::string name_of(const std::string &what, size_t target)
{
    return what + ", morph target " + std::to_string(target);
}
} // namespace

void check_targets(const char *path, const std::string &what, const Accessors &accessors,
                   const std::vector<int> &targets, uint64_t vertices)
{
    for (size_t i = 0; i < targets.size(); i++) {
        const std::string name = name_of(what, i);
        if (targets[i] < 0)
            continue;
        accessors.check_positions(targets[i], name);
        if (accessors.count(targets[i]) != vertices)
            fail(BB_INVALID, "%s: %s: has %llu vertices, the primitive has %llu", path,
                 name.c_str(), static_cast<unsigned long long>(accessors.count(targets[i])),
                 static_cast<unsigned long long>(vertices));
        accessors.read_numbers(targets[i], name, [&](uint64_t vertex, const double *d) {
            if (!std::isfinite(d[0]) || !std::isfinite(d[1]) || !std::isfinite(d[2]))
                fail(BB_INVALID, "%s: %s: vertex %llu is moved by (%g %g %g), which is not finite",
                     path, name.c_str(), static_cast<unsigned long long>(vertex), d[0], d[1], d[2]);
        });
    }
}

void add_targets(const std::string &what, const Accessors &accessors,
                 const std::vector<int> &targets, const std::vector<double> &weights,
                 std::vector<double> &points)
{
    for (size_t i = 0; i < targets.size(); i++) {
        const double weight = weights[i];
        if (targets[i] < 0 || weight == 0)
            continue;
        accessors.read_numbers(targets[i], name_of(what, i), [&](uint64_t vertex, const double *d) {
            for (size_t axis = 0; axis < 3; axis++)
                points[3 * vertex + axis] += weight * d[axis];
        });
    }
}
} // namespace bb_gltf
