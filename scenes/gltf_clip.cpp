/* Channels of an animation (glTF 2.0 specification, section 3.11): keyframes are read and checked
 * once, and then sampled. */
#include "scenes/gltf_clip.hpp"

#include <algorithm>
#include <cmath>

namespace bb_gltf
{
Clip::Clip(const char *path, const Document &document, const Accessors &accessors)
    : path_(path), document_(document), accessors_(accessors)
{
    start_ = INFINITY;
    end_ = -INFINITY;
    for (const Channel &channel : document.moving->channels) {
        const std::string what =
            document.moving->clip + ", channel " + std::to_string(channel.number);
        movers_.push_back(read_channel(channel, what));
        const std::vector<double> &times = movers_.back().track.times;
        start_ = std::min(start_, times.front());
        end_ = std::max(end_, times.back());
    }
}

/* Counts memory, since many channels may share one accessor of the file. */
void Clip::take(uint64_t numbers)
{
    bytes_ += numbers * sizeof(double);
    if (bytes_ > bb_host_limit())
        fail(BB_REFUSED,
             "%s: %s: its keyframes need %llu bytes or more, three quarters of the host's memory "
             "are %llu: take a smaller scene",
             path_, document_.moving->clip.c_str(), static_cast<unsigned long long>(bytes_),
             static_cast<unsigned long long>(bb_host_limit()));
}

/* Times increase, so few elements can be zero, as elements without data in the file are. This is
 * checked before memory is allocated for them. */
void Clip::read_times(int accessor, const std::string &what, Track &track)
{
    accessors_.check_numbers(accessor, what + ", times", TINYGLTF_TYPE_SCALAR, Accessors::floats,
                             "SCALAR of float");
    const uint64_t count = accessors_.count(accessor);
    if (count > accessors_.given(accessor) + 1)
        fail(BB_INVALID, "%s: %s: its times do not rise: most of them are not in the file", path_,
             what.c_str());
    take(count);
    track.times.resize(count);
    accessors_.read_numbers(accessor, what + ", times",
                            [&](uint64_t key, const double *time) { track.times[key] = time[0]; });
    for (size_t key = 0; key < count; key++)
        if (!std::isfinite(track.times[key]) ||
            (key > 0 && !(track.times[key] > track.times[key - 1])))
            fail(BB_INVALID, "%s: %s: the time of keyframe %zu is %g: must be finite and rise",
                 path_, what.c_str(), key, track.times[key]);
}

/* An element of the accessor has `numbers` numbers: a vector, a quaternion, or one weight of
 * several. */
void Clip::read_values(int accessor, const std::string &what, uint64_t numbers, Track &track)
{
    const uint64_t count = accessors_.count(accessor);
    const uint64_t per_key = track.interpolation == Interpolation::cubic ? 3 : 1;
    const uint64_t values = track.times.size() * per_key * track.width;
    if (count != values / numbers)
        fail(BB_INVALID, "%s: %s: has %llu values, its %zu keyframes need %llu", path_,
             what.c_str(), static_cast<unsigned long long>(count), track.times.size(),
             static_cast<unsigned long long>(values / numbers));
    take(values);
    track.values.resize(values);
    accessors_.read_numbers(accessor, what + ", values",
                            [&](uint64_t element, const double *value) {
                                std::copy(value, value + numbers, &track.values[element * numbers]);
                            });
    for (size_t i = 0; i < track.values.size(); i++)
        if (!std::isfinite(track.values[i]))
            fail(BB_INVALID, "%s: %s: the value of keyframe %llu is not finite", path_,
                 what.c_str(), static_cast<unsigned long long>(i / (per_key * track.width)));
}

/* The same check as for a node's own rotation; rotations that are interpolated on arcs are
 * normalised. */
void Clip::check_rotations(const std::string &what, Track &track) const
{
    const bool cubic = track.interpolation == Interpolation::cubic;
    for (size_t key = 0; key < track.times.size(); key++) {
        double *q = &track.values[4 * (cubic ? 3 * key + 1 : key)];
        const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        if (!(std::fabs(length - 1) < 0.01))
            fail(BB_INVALID, "%s: %s: keyframe %zu is a quaternion of length %g, must be 1", path_,
                 what.c_str(), key, length);
        for (int i = 0; i < 4 && track.interpolation == Interpolation::linear; i++)
            q[i] /= length;
    }
}

Clip::Mover Clip::read_channel(const Channel &channel, const std::string &what)
{
    const unsigned fractions =
        Accessors::floats | Accessors::unsigned_fractions | Accessors::signed_fractions;
    Mover out = {channel.node, channel.path, {}};
    Track &track = out.track;
    track.interpolation = channel.interpolation;
    track.rotation = channel.path == Path::rotation;
    track.width = track.rotation ? 4 : 3;
    if (channel.path == Path::weights) {
        const int mesh = document_.model.nodes[static_cast<size_t>(channel.node)].mesh;
        track.width =
            mesh >= 0 ? document_.moving->meshes[static_cast<size_t>(mesh)].target_count : 0;
        if (track.width == 0)
            fail(BB_INVALID, "%s: %s: moves weights of node %d, which has no morph targets", path_,
                 what.c_str(), channel.node);
        accessors_.check_numbers(channel.output, what + ", weights", TINYGLTF_TYPE_SCALAR,
                                 fractions, "SCALAR of float or normalized integers");
    } else if (track.rotation) {
        accessors_.check_numbers(channel.output, what + ", rotations", TINYGLTF_TYPE_VEC4,
                                 fractions, "VEC4 of float or normalized integers");
    } else {
        accessors_.check_numbers(channel.output, what + ", values", TINYGLTF_TYPE_VEC3,
                                 Accessors::floats, "VEC3 of float");
    }
    read_times(channel.input, what, track);
    read_values(channel.output, what, channel.path == Path::weights ? 1 : track.width, track);
    if (track.rotation)
        check_rotations(what, track);
    return out;
}

void Clip::set(double time, const std::string &what, tinygltf::Model &model,
               NodeWeights &weights) const
{
    for (const Mover &mover : movers_) {
        tinygltf::Node &node = model.nodes[static_cast<size_t>(mover.node)];
        std::vector<double> *const lists[] = {&node.translation, &node.rotation, &node.scale,
                                              &weights[static_cast<size_t>(mover.node)]};
        std::vector<double> &list = *lists[static_cast<int>(mover.path)];
        list.resize(mover.track.width);
        sample(mover.track, time, list.data());
        if (mover.path != Path::rotation)
            continue;
        double length = 0;
        for (const double part : list)
            length += part * part;
        length = std::sqrt(length);
        if (!(length > 0) || !std::isfinite(length))
            fail(BB_INVALID, "%s: %s, %s: the rotation of node %d is a quaternion of length %g",
                 path_, document_.moving->clip.c_str(), what.c_str(), mover.node, length);
        for (double &part : list)
            part /= length;
    }
}
} // namespace bb_gltf
