/* One animation of a glTF file, ready to be sampled. */
#ifndef BB_GLTF_CLIP_HPP
#define BB_GLTF_CLIP_HPP

#include "scenes/gltf_accessors.hpp"
#include "scenes/gltf_sampler.hpp"

namespace bb_gltf
{
/* The weights of each node's morph targets. */
using NodeWeights = std::vector<std::vector<double>>;

class Clip
{
  public:
    /* Reads and checks the keyframes of the document's clip. */
    Clip(const char *path, const Document &document, const Accessors &accessors);

    /* In seconds: the first and the last keyframe of all channels. */
    double start() const
    {
        return start_;
    }
    double end() const
    {
        return end_;
    }
    /* Moves the nodes of the model, and sets the weights of those whose weights are animated.
     * `what` names the time in messages. Fails where a spline of rotations passes through 0. */
    void set(double time, const std::string &what, tinygltf::Model &model,
             NodeWeights &weights) const;

  private:
    struct Mover {
        int node;
        Path path;
        Track track;
    };

    Mover read_channel(const Channel &channel, const std::string &what);
    void read_times(int accessor, const std::string &what, Track &track);
    void read_values(int accessor, const std::string &what, uint64_t numbers, Track &track);
    void check_rotations(const std::string &what, Track &track) const;
    void take(uint64_t numbers);

    const char *path_;
    const Document &document_;
    const Accessors &accessors_;
    std::vector<Mover> movers_;
    uint64_t bytes_ = 0; /* of all keyframes, decoded */
    double start_, end_;
};
} // namespace bb_gltf

#endif
