/* Morph targets: displacements of a primitive's vertices, each with a weight. */
#ifndef BB_GLTF_MORPH_HPP
#define BB_GLTF_MORPH_HPP

#include "scenes/gltf_accessors.hpp"

namespace bb_gltf
{
/* Fails on targets that are not finite displacements of `vertices` vertices; reads them all. */
void check_targets(const char *path, const std::string &what, const Accessors &accessors,
                   const std::vector<int> &targets, uint64_t vertices);

/* Adds each target, times its weight, to `points` (x y z of each vertex); targets of weight 0 are
 * not read.
 */
void add_targets(const std::string &what, const Accessors &accessors,
                 const std::vector<int> &targets, const std::vector<double> &weights,
                 std::vector<double> &points);
} // namespace bb_gltf

#endif
