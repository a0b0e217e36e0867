/* Frames of a clip: samples the nodes' properties, accumulates their transforms, adds morph
 * targets, then applies skins or the nodes' transforms; all in double precision, rounded once. */
#include "scenes/gltf_pose.hpp"
#include "scenes/gltf_morph.hpp"

#include <algorithm>
#include <cmath>

namespace bb_gltf
{
Pose::Pose(const char *path, Document &document, const Accessors &accessors, Placement &placement,
           const Plan &plan, uint32_t frames)
    : path_(path), document_(document), accessors_(accessors), placement_(placement), plan_(plan),
      clip_(path, document, accessors), frames_(frames)
{
    start_weights();
    refuse_too_much();
    influences_.resize(plan_.parts().size());
    for (size_t i = 0; i < plan_.parts().size(); i++)
        if (!plan_.parts()[i].shared)
            read_part(i);
}

const Deformers &Pose::deformers_of(const Part &part) const
{
    return document_.moving->meshes[static_cast<size_t>(part.mesh)]
        .primitives[static_cast<size_t>(part.primitive)];
}

int Pose::skin_of(const Part &part) const
{
    return document_.moving->nodes[static_cast<size_t>(part.node)].skin;
}

std::string Pose::name_of(const Part &part) const
{
    return "frame " + std::to_string(frame_) + ", " + plan_.name_of(part);
}

/* Takes the node's own weights, else its mesh's, else 0. */
void Pose::start_weights()
{
    for (size_t i = 0; i < document_.model.nodes.size(); i++) {
        const int mesh = document_.model.nodes[i].mesh;
        weights_.push_back(document_.moving->nodes[i].weights);
        if (mesh < 0 || !weights_[i].empty())
            continue;
        const MeshDeformers &of = document_.moving->meshes[static_cast<size_t>(mesh)];
        weights_[i] = of.weights;
        weights_[i].resize(of.target_count);
    }
}

/* Counts points in double precision, for one part at a time, and the joints of all. */
void Pose::refuse_too_much() const
{
    uint64_t most = 0, sum = 0;
    for (const Part &part : plan_.parts()) {
        const uint64_t vertices = accessors_.count(part.positions);
        if (part.shared)
            continue;
        most = std::max(most, vertices * 3 * sizeof(double));
        if (skin_of(part) >= 0)
            sum += bytes_of_influences(deformers_of(part), vertices);
    }
    if (most + sum > bb_host_limit())
        fail(BB_REFUSED,
             "%s: moving it needs %llu bytes, three quarters of the host's memory are %llu: take "
             "a smaller scene",
             path_, static_cast<unsigned long long>(most + sum),
             static_cast<unsigned long long>(bb_host_limit()));
}

void Pose::read_part(size_t number)
{
    const Part &part = plan_.parts()[number];
    const Deformers &deformers = deformers_of(part);
    const uint64_t vertices = accessors_.count(part.positions);
    const std::string what = plan_.name_of(part);
    const int skin = skin_of(part);
    check_targets(path_, what, accessors_, deformers.targets, vertices);
    if (skin < 0)
        return;
    if (deformers.joints.empty())
        fail(BB_INVALID, "%s: %s: node %d has skin %d, but it has no JOINTS_0 and WEIGHTS_0", path_,
             what.c_str(), part.node, skin);
    auto known = skins_.find(skin);
    if (known == skins_.end())
        known =
            skins_.emplace(skin, read_joints(path_, skin, document_, accessors_, placement_)).first;
    influences_[number] =
        read_influences(path_, what, accessors_, deformers, vertices, known->second.nodes.size());
}

/* ---- frames ---- */

void Pose::set(uint32_t frame)
{
    const double start = clip_.start(), end = clip_.end();
    const double time = start + (end - start) * frame / (frames_ - 1);
    frame_ = frame;
    clip_.set(frame + 1 == frames_ ? end : time, "frame " + std::to_string(frame), document_.model,
              weights_);
    place_again(path_, document_.model, placement_);
}

void Pose::fill(float *vertices) const
{
    for (size_t i = 0; i < plan_.parts().size(); i++)
        if (!plan_.parts()[i].shared)
            fill_part(i, vertices);
}

void Pose::fill_part(size_t number, float *vertices) const
{
    const Part &part = plan_.parts()[number];
    const Deformers &deformers = deformers_of(part);
    const std::string what = name_of(part);
    const int skin = skin_of(part);
    if (skin < 0 && deformers.targets.empty())
        return plan_.fill_positions(part, what, vertices);
    std::vector<double> points(3 * accessors_.count(part.positions));
    accessors_.read_numbers(
        part.positions, what + ", POSITION",
        [&](uint64_t vertex, const double *p) { std::copy(p, p + 3, &points[3 * vertex]); });
    add_targets(what, accessors_, deformers.targets, weights_[static_cast<size_t>(part.node)],
                points);
    if (skin >= 0)
        skin_points(influences_[number], place_joints(skins_.at(skin), placement_), points);
    else
        for (size_t i = 0; i < points.size(); i += 3) {
            const double p[3] = {points[i], points[i + 1], points[i + 2]};
            transform_point(placement_.transform[static_cast<size_t>(part.node)], p, &points[i]);
        }
    put_points(part, points, vertices);
}

void Pose::put_points(const Part &part, const std::vector<double> &points, float *vertices) const
{
    float *out = vertices + 3 * part.vertex_base;
    for (size_t i = 0; i < points.size(); i++) {
        out[i] = static_cast<float>(points[i]);
        if (!std::isfinite(out[i])) {
            const double *p = &points[i - i % 3];
            fail(BB_INVALID, "%s: %s: vertex %zu is not finite: (%g %g %g)", path_,
                 name_of(part).c_str(), i / 3, p[0], p[1], p[2]);
        }
    }
}
} // namespace bb_gltf
