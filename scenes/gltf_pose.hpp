/* A glTF file in motion: positions of its vertices in a frame of a clip. */
#ifndef BB_GLTF_POSE_HPP
#define BB_GLTF_POSE_HPP

#include "scenes/gltf_clip.hpp"
#include "scenes/gltf_plan.hpp"
#include "scenes/gltf_skin.hpp"

namespace bb_gltf
{
class Pose
{
  public:
    /* Reads and checks everything that moves; the document's clip is played in `frames` frames, at
     * least 2. The other arguments must outlive it; set() changes document and placement. */
    Pose(const char *path, Document &document, const Accessors &accessors, Placement &placement,
         const Plan &plan, uint32_t frames);

    /* Moves the nodes to their places in a frame. */
    void set(uint32_t frame);
    /* Computes the vertices of the current frame. Fails if one is not finite. */
    void fill(float *vertices) const;

  private:
    const Deformers &deformers_of(const Part &part) const;
    int skin_of(const Part &part) const;
    std::string name_of(const Part &part) const;
    void refuse_too_much() const;
    void read_part(size_t part);
    void start_weights();
    void fill_part(size_t part, float *vertices) const;
    void put_points(const Part &part, const std::vector<double> &points, float *vertices) const;

    const char *path_;
    Document &document_;
    const Accessors &accessors_;
    Placement &placement_;
    const Plan &plan_;
    const Clip clip_;
    uint32_t frames_, frame_ = 0;
    NodeWeights weights_;
    std::map<int, Joints> skins_;        /* those that parts use */
    std::vector<Influences> influences_; /* of each part; none without a skin */
};
} // namespace bb_gltf

#endif
