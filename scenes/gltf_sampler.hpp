/* A property of a node over time. */
#ifndef BB_GLTF_SAMPLER_HPP
#define BB_GLTF_SAMPLER_HPP

#include "scenes/gltf_parts.hpp"

namespace bb_gltf
{
/* Keyframes, decoded. */
struct Track {
    Interpolation interpolation;
    bool rotation;              /* the values are quaternions x y z w; of length 1 if linear */
    size_t width;               /* numbers of a value */
    std::vector<double> times;  /* rising; one at least */
    std::vector<double> values; /* of each time; if cubic: in-tangent, value, out-tangent of each */
};

/* The value at a time, `width` numbers; before the first keyframe the first's, after the last the
 * last's. A rotation between two cubic keyframes is not of length 1. */
void sample(const Track &track, double time, double *out);
} // namespace bb_gltf

#endif
