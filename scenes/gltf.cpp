/* The C interface of the glTF loader: exceptions end here. */
#include "scenes/gltf_pose.hpp"

extern "C" {
#include "scenes/gltf.h"
}

#include <algorithm>
#include <memory>
#include <new>

namespace bb_gltf
{
namespace
{
/* A document with its nodes placed. Its parts refer to each other, so it must not move in memory.
 */
struct File {
    File(const char *name, const char *clip)
        : path(name), document(read_document(path, clip)), accessors(path.c_str(), document),
          placement(place_nodes(path.c_str(), document.model)),
          plan(path.c_str(), document, accessors, placement)
    {
    }
    File(const File &) = delete;
    File &operator=(const File &) = delete;

    const std::string path;
    Document document;
    const Accessors accessors;
    Placement placement;
    const Plan plan;
};

void check(bb_status status)
{
    if (status != BB_OK)
        throw Failure{status};
}

float *reserve(const File &file, const bb_gltf_taker &taker)
{
    float *vertices = nullptr;
    uint32_t *triangles = nullptr;
    check(taker.reserve(taker.user, file.plan.vertex_count(), file.plan.triangle_count(), &vertices,
                        &triangles));
    file.plan.fill_triangles(triangles);
    return vertices;
}

void give_views(const File &file, const bb_gltf_taker &taker)
{
    for (const NamedView &one : find_views(file.document, file.placement))
        taker.add_view(taker.user, one.name.c_str(), &one.view);
}

uint32_t clamp(uint64_t count)
{
    return static_cast<uint32_t>(std::min<uint64_t>(count, UINT32_MAX));
}

template <typename Body> bb_status guard(const char *path, const Body &body)
{
    try {
        body();
        return BB_OK;
    } catch (const Failure &failure) {
        return failure.status;
    } catch (const std::bad_alloc &) {
        return bb_fail(BB_REFUSED, "%s: needs more memory than there is", path);
    } catch (const std::exception &error) {
        return bb_fail(BB_INVALID, "%s: cannot be read: %s", path, error.what());
    }
}
} // namespace
} // namespace bb_gltf

struct bb_gltf_moving {
    bb_gltf_moving(const char *path, const char *clip) : file(path, clip)
    {
    }
    bb_gltf::File file;
    std::unique_ptr<bb_gltf::Pose> pose;
};

extern "C" bb_status bb_gltf_load(const char *path, const bb_gltf_taker *taker, uint32_t *ignored)
{
    return bb_gltf::guard(path, [&] {
        const bb_gltf::File file(path, nullptr);
        float *vertices = bb_gltf::reserve(file, *taker);
        for (const bb_gltf::Part &part : file.plan.parts())
            if (!part.shared)
                file.plan.fill_positions(part, file.plan.name_of(part), vertices);
        *ignored = bb_gltf::clamp(file.plan.ignored());
        bb_gltf::give_views(file, *taker);
    });
}

extern "C" bb_status bb_gltf_load_clip(const char *path, const char *clip, uint32_t frames,
                                       const bb_gltf_taker *taker, uint32_t *ignored,
                                       bb_gltf_moving **moving)
{
    *moving = nullptr;
    return bb_gltf::guard(path, [&] {
        auto made = std::make_unique<bb_gltf_moving>(path, clip);
        bb_gltf::File &file = made->file;
        float *vertices = bb_gltf::reserve(file, *taker);
        made->pose = std::make_unique<bb_gltf::Pose>(
            file.path.c_str(), file.document, file.accessors, file.placement, file.plan, frames);
        made->pose->set(0);
        made->pose->fill(vertices);
        *ignored = bb_gltf::clamp(file.plan.ignored() + file.document.moving->ignored);
        bb_gltf::give_views(file, *taker);
        *moving = made.release();
    });
}

extern "C" bb_status bb_gltf_pose(bb_gltf_moving *moving, uint32_t frame, float *vertices)
{
    return bb_gltf::guard(moving->file.path.c_str(), [&] {
        moving->pose->set(frame);
        moving->pose->fill(vertices);
    });
}

extern "C" void bb_gltf_free(bb_gltf_moving *moving)
{
    delete moving;
}
