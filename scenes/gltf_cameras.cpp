/* Cameras of glTF nodes (glTF 2.0 specification, section 3.10) as views. Since they are not
 * geometry, a damaged one is left out, and the file is read nevertheless. */
#include "scenes/gltf_nodes.hpp"
#include "scenes/gltf_parts.hpp"

#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>

namespace bb_gltf
{
using nlohmann::json;

namespace
{
/* Returns null for a missing member. */
const json &member(const json &object, const char *key)
{
    static const json none;
    const auto found = object.is_object() ? object.find(key) : object.end();
    return found != object.end() ? *found : none;
}

std::string text_in(const json &object, const char *key)
{
    const json &value = member(object, key);
    return value.is_string() ? value.get<std::string>() : std::string();
}

/* Returns 0 if the member is not a number. */
double number_in(const json &object, const char *key)
{
    const json &value = member(object, key);
    return value.is_number() ? value.get<double>() : 0;
}

/* Returns the nodes of the default scene; those of all scenes if the file names no default. */
std::vector<int> shown_nodes(const tinygltf::Model &model, const Placement &placement)
{
    const int scene = model.defaultScene;
    if (scene < 0 || static_cast<size_t>(scene) >= model.scenes.size())
        return placement.order;
    std::vector<int> order, stack = model.scenes[static_cast<size_t>(scene)].nodes;
    std::reverse(stack.begin(), stack.end());
    while (!stack.empty()) {
        const int node = stack.back();
        stack.pop_back();
        order.push_back(node);
        const std::vector<int> &children = model.nodes[static_cast<size_t>(node)].children;
        stack.insert(stack.end(), children.rbegin(), children.rend());
    }
    return order;
}

/* Looks from the node's origin along its -z, with y up. Returns false if that gives no
 * direction. */
bool place(const Camera &camera, const Transform &t, bb_view &view)
{
    double length = 0, far = 1;
    for (int axis = 0; axis < 3; axis++) {
        view.eye[axis] = t.m[axis][3];
        view.up[axis] = t.m[axis][1];
        length = std::hypot(length, t.m[axis][2]);
        far = std::max(far, std::fabs(t.m[axis][3]));
    }
    for (int axis = 0; axis < 3; axis++)
        view.target[axis] = view.eye[axis] - t.m[axis][2] / length * far;
    view.parallel = camera.parallel;
    view.fov_y = camera.extent;
    return length > 0 && std::isfinite(length) && far <= 1e30;
}
} // namespace

std::map<int, Camera> find_cameras(const json &root)
{
    constexpr double degrees = 180 / 3.14159265358979323846;
    const json &nodes = member(root, "nodes"), &list = member(root, "cameras");
    std::map<int, Camera> cameras;
    for (size_t node = 0; list.is_array() && node < nodes.size(); node++) {
        const json &index = member(nodes[node], "camera");
        if (!index.is_number_unsigned() || index.get<uint64_t>() >= list.size())
            continue;
        const json &camera = list[index.get<size_t>()];
        const bool parallel = text_in(camera, "type") == "orthographic";
        const double extent = parallel ? 2 * number_in(member(camera, "orthographic"), "ymag")
                                       : degrees * number_in(member(camera, "perspective"), "yfov");
        std::string name = text_in(camera, "name");
        if (name.empty())
            name = text_in(nodes[node], "name");
        cameras[static_cast<int>(node)] = {name.empty() ? "camera" : name, parallel, extent};
    }
    return cameras;
}

std::vector<NamedView> find_views(const Document &document, const Placement &placement)
{
    std::vector<NamedView> views;
    if (document.cameras.empty())
        return views;
    for (const int node : shown_nodes(document.model, placement)) {
        const auto camera = document.cameras.find(node);
        bb_view view = {};
        if (camera != document.cameras.end() &&
            place(camera->second, placement.transform[static_cast<size_t>(node)], view))
            views.push_back({camera->second.name, view});
    }
    return views;
}
} // namespace bb_gltf
