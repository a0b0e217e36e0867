/* Interpolation of keyframes (glTF 2.0 specification, appendix C): steps, straight lines, great
 * arcs between rotations, cubic Hermite splines. Equal on every machine. */
#include "scenes/gltf_sampler.hpp"

extern "C" {
#include "scenes/repeatable.h"
}

#include <algorithm>

namespace bb_gltf
{
namespace
{
const double *value_of(const Track &track, size_t key)
{
    const bool cubic = track.interpolation == Interpolation::cubic;
    return &track.values[(cubic ? 3 * key + 1 : key) * track.width];
}

double length_of(const double q[4])
{
    return std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
}

/* C.4: along the shorter arc, at constant speed. The angle between the two is twice the arctangent
 * of the ratio of the lengths of their difference and sum (Kahan), which is accurate for small and
 * large angles, unlike the arccosine of their product. */
void interpolate_arc(const double a[4], const double b[4], double u, double out[4])
{
    double product = 0, difference[4], sum[4];
    for (int i = 0; i < 4; i++)
        product += a[i] * b[i];
    const double sign = product < 0 ? -1 : 1;
    for (int i = 0; i < 4; i++) {
        difference[i] = a[i] - sign * b[i];
        sum[i] = a[i] + sign * b[i];
    }
    /* At most 1, except for rounding, since the shorter arc is at most a quarter of a turn. */
    const double ratio = std::min(length_of(difference) / length_of(sum), 1.0);
    const double angle = 2 * bb_arctangent(ratio), whole = bb_sine(angle);
    const double from = whole > 0 ? bb_sine(angle * (1 - u)) / whole : 1 - u;
    const double to = whole > 0 ? bb_sine(angle * u) / whole : u;
    for (int i = 0; i < 4; i++)
        out[i] = from * a[i] + sign * to * b[i];
}

/* C.5: tangents are per second. */
void interpolate_spline(const Track &track, size_t key, double u, double *out)
{
    const double span = track.times[key + 1] - track.times[key], u2 = u * u, u3 = u2 * u;
    const double *from = value_of(track, key), *to = value_of(track, key + 1);
    const double *leaving = from + track.width, *arriving = to - track.width;
    for (size_t i = 0; i < track.width; i++)
        out[i] = (2 * u3 - 3 * u2 + 1) * from[i] + span * (u3 - 2 * u2 + u) * leaving[i] +
                 (3 * u2 - 2 * u3) * to[i] + span * (u3 - u2) * arriving[i];
}
} // namespace

void sample(const Track &track, double time, double *out)
{
    const auto after = std::upper_bound(track.times.begin(), track.times.end(), time);
    const size_t next = static_cast<size_t>(after - track.times.begin());
    const size_t key = next > 0 ? next - 1 : 0;
    const double *from = value_of(track, key);
    /* A keyframe's own time gives its value, bit for bit. */
    if (next == 0 || next == track.times.size() || time == track.times[key] ||
        track.interpolation == Interpolation::step) {
        std::copy(from, from + track.width, out);
        return;
    }
    const double u = (time - track.times[key]) / (track.times[next] - track.times[key]);
    if (track.interpolation == Interpolation::cubic)
        return interpolate_spline(track, key, u, out);
    const double *to = value_of(track, next);
    if (track.rotation)
        return interpolate_arc(from, to, u, out);
    for (size_t i = 0; i < track.width; i++)
        out[i] = (1 - u) * from[i] + u * to[i];
}
} // namespace bb_gltf
