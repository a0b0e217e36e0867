/* A property of a node over time. */
#ifndef BB_GLTF_SAMPLER_HPP
#define BB_GLTF_SAMPLER_HPP

#include "scenes/gltf_parts.hpp"

namespace bb_gltf
{
/* Keyframes, decoded. */
struct Track {
    Interpolation interpolation;
    bool rotation;              /* the values are quaternions x y z w, of length 1 if linear */
    size_t width;               /* numbers per value */
    std::vector<double> times;  /* increasing; at least one */
    std::vector<double> values; /* per time; if cubic: in-tangent, value, out-tangent */
};

/* Computes the value at a time, `width` numbers; before the first keyframe it is the first one's,
 * after the last the last one's. A rotation between two cubic keyframes does not have length 1. */
void sample(const Track &track, double time, double *out);
} // namespace bb_gltf

#endif
