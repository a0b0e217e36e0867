/* Animations, skins and morph targets of a glTF document (glTF 2.0 specification, sections 3.7.2.2,
 * 3.7.3 and 3.11), from its checked JSON. They are hidden from tinygltf, which refuses a whole file
 * for an animation or skin that it cannot read, and does not support weights of nodes. */
#include "scenes/gltf_parts.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>

namespace bb_gltf
{
using nlohmann::json;

namespace
{
constexpr size_t clips_shown = 12, name_shown = 40;

const json &list_in(const json &object, const char *key)
{
    static const json none = json::array();
    const auto found = object.find(key);
    return found != object.end() ? *found : none;
}

int index_in(const json &object, const char *key)
{
    const auto found = object.find(key);
    return found != object.end() ? found->get<int>() : -1;
}

std::string text_in(const json &object, const char *key)
{
    const auto found = object.find(key);
    return found != object.end() ? found->get<std::string>() : std::string();
}

/* ---- the clip ---- */

std::string list_clips(const json &animations)
{
    std::string text;
    for (size_t i = 0; i < animations.size() && i < clips_shown; i++) {
        const std::string name = text_in(animations[i], "name").substr(0, name_shown);
        text += (i > 0 ? ", " : "") + std::to_string(i) + (name.empty() ? "" : " " + name);
    }
    return text + (animations.size() > clips_shown ? ", ..." : "");
}

bool is_number(const std::string &text)
{
    return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

/* Digits are a number, whatever the names of the clips. */
size_t find_clip(const char *path, const json &animations, const std::string &clip)
{
    if (animations.empty())
        fail(BB_INVALID,
             "%s: has no clip '%s': it has no animations; without clip= it is read as it stands",
             path, clip.c_str());
    std::vector<size_t> found;
    if (is_number(clip)) {
        if (clip.size() < 10 && std::stoul(clip) < animations.size())
            found.push_back(std::stoul(clip));
    } else {
        for (size_t i = 0; i < animations.size(); i++)
            if (text_in(animations[i], "name") == clip)
                found.push_back(i);
    }
    if (found.empty())
        fail(BB_INVALID, "%s: has no clip '%s': take one of %s", path, clip.c_str(),
             list_clips(animations).c_str());
    if (found.size() > 1)
        fail(BB_INVALID, "%s: %zu clips are called '%s': give the number of one, such as clip=%zu",
             path, found.size(), clip.c_str(), found[0]);
    return found[0];
}

/* ---- channels ---- */

/* Returns false for an unknown path. */
bool take_path(const std::string &text, Path &path)
{
    static const char *const names[] = {"translation", "rotation", "scale", "weights"};
    for (int i = 0; i < 4; i++)
        if (text == names[i]) {
            path = static_cast<Path>(i);
            return true;
        }
    return false;
}

Interpolation take_interpolation(const char *path, const std::string &what, const json &sampler)
{
    const std::string text = text_in(sampler, "interpolation");
    if (text.empty() || text == "LINEAR")
        return Interpolation::linear;
    if (text != "STEP" && text != "CUBICSPLINE")
        fail(BB_INVALID, "%s: %s: interpolation is '%.40s', must be LINEAR, STEP or CUBICSPLINE",
             path, what.c_str(), text.c_str());
    return text == "STEP" ? Interpolation::step : Interpolation::cubic;
}

/* A node's property may be moved by only one channel, and not if the node has a matrix. */
void check_target(const char *path, const std::string &what, const json &nodes,
                  const Channel &channel, std::set<std::pair<int, Path>> &taken)
{
    if (!taken.emplace(channel.node, channel.path).second)
        fail(BB_INVALID, "%s: %s: moves the same property as another channel: remove one", path,
             what.c_str());
    if (channel.path != Path::weights &&
        nodes[static_cast<size_t>(channel.node)].contains("matrix"))
        fail(BB_INVALID,
             "%s: %s: moves node %d, which has a matrix: must have translation, rotation and scale",
             path, what.c_str(), channel.node);
}

void take_channels(const char *path, const json &root, const json &animation, Moving &out)
{
    const json &samplers = list_in(animation, "samplers");
    std::set<std::pair<int, Path>> taken;
    int number = -1;
    for (const json &one : list_in(animation, "channels")) {
        const std::string what = out.clip + ", channel " + std::to_string(++number);
        const auto target = one.find("target");
        const int sampler = index_in(one, "sampler");
        if (target == one.end() || sampler < 0 || static_cast<size_t>(sampler) >= samplers.size())
            fail(BB_INVALID, "%s: %s: has no target, or no valid sampler", path, what.c_str());
        Channel channel = {};
        channel.number = number;
        channel.node = index_in(*target, "node");
        if (channel.node < 0 || !take_path(text_in(*target, "path"), channel.path)) {
            out.ignored++;
            continue;
        }
        const json &from = samplers[static_cast<size_t>(sampler)];
        channel.interpolation = take_interpolation(path, what, from);
        channel.input = index_in(from, "input");
        channel.output = index_in(from, "output");
        if (channel.input < 0 || channel.output < 0)
            fail(BB_INVALID, "%s: %s: its sampler has no input or no output", path, what.c_str());
        check_target(path, what, root["nodes"], channel, taken);
        out.channels.push_back(channel);
    }
    if (out.channels.empty())
        fail(BB_INVALID, "%s: %s: moves no node: take another clip", path, out.clip.c_str());
}

/* Its channels may move any property. */
void check_extensions(const char *path, const json &root)
{
    for (const json &name : list_in(root, "extensionsRequired"))
        if (name.get_ref<const std::string &>() == "KHR_animation_pointer")
            fail(BB_UNSUPPORTED,
                 "%s: needs the extension KHR_animation_pointer, which is not supported: without "
                 "clip= it is read as it stands",
                 path);
}

/* ---- skins and morph targets ---- */

/* JOINTS_0, JOINTS_1, ... */
std::vector<int> take_sets(const char *path, const std::string &what, const json &attributes,
                           const char *stem, size_t accessors)
{
    std::vector<int> out;
    for (;;) {
        const std::string name = stem + std::to_string(out.size());
        const auto found = attributes.find(name);
        if (found == attributes.end())
            return out;
        if (!found->is_number_unsigned() || found->get<uint64_t>() >= accessors)
            fail(BB_INVALID, "%s: %s: %s is no valid accessor", path, what.c_str(), name.c_str());
        out.push_back(found->get<int>());
    }
}

MeshDeformers take_mesh(const char *path, const json &root, size_t number)
{
    const json &mesh = root["meshes"][number];
    const size_t accessors = list_in(root, "accessors").size();
    MeshDeformers out = {};
    for (const json &primitive : list_in(mesh, "primitives")) {
        const std::string what = "mesh " + std::to_string(number) + ", primitive " +
                                 std::to_string(out.primitives.size());
        const json &targets = list_in(primitive, "targets");
        Deformers deformers;
        if (out.primitives.empty())
            out.target_count = targets.size();
        if (out.target_count != targets.size())
            fail(BB_INVALID, "%s: %s: has %zu morph targets, but primitive 0 has %zu", path,
                 what.c_str(), targets.size(), out.target_count);
        for (const json &target : targets)
            deformers.targets.push_back(index_in(target, "POSITION"));
        const json &attributes = list_in(primitive, "attributes");
        deformers.joints = take_sets(path, what, attributes, "JOINTS_", accessors);
        deformers.weights = take_sets(path, what, attributes, "WEIGHTS_", accessors);
        if (deformers.joints.size() != deformers.weights.size())
            fail(BB_INVALID, "%s: %s: has %zu sets of JOINTS_ and %zu of WEIGHTS_", path,
                 what.c_str(), deformers.joints.size(), deformers.weights.size());
        out.primitives.push_back(deformers);
    }
    return out;
}

/* Gets the weights of a mesh or a node: one for each morph target, or none. */
std::vector<double> take_weights(const char *path, const char *what, size_t number,
                                 const json &object, size_t targets)
{
    const json &list = list_in(object, "weights");
    if (!list.empty() && list.size() != targets)
        fail(BB_INVALID, "%s: %s %zu: has %zu weights, but its mesh has %zu morph targets", path,
             what, number, list.size(), targets);
    return list.get<std::vector<double>>();
}

NodeDeformers take_node(const char *path, const json &root, size_t number, const Moving &moving)
{
    const json &node = root["nodes"][number];
    const int mesh = index_in(node, "mesh");
    const size_t targets = mesh >= 0 ? moving.meshes[static_cast<size_t>(mesh)].target_count : 0;
    return {take_weights(path, "node", number, node, targets), index_in(node, "skin")};
}
} // namespace

Moving find_moving(const char *path, const json &root, const std::string &clip)
{
    Moving out;
    const json &animations = list_in(root, "animations");
    const size_t number = find_clip(path, animations, clip);
    const std::string name = text_in(animations[number], "name").substr(0, name_shown);
    out.clip = "clip " + std::to_string(number) + (name.empty() ? "" : " (" + name + ")");
    check_extensions(path, root);
    take_channels(path, root, animations[number], out);
    for (const json &skin : list_in(root, "skins"))
        out.skins.push_back({list_in(skin, "joints").get<std::vector<int>>(),
                             index_in(skin, "inverseBindMatrices")});
    for (size_t i = 0; i < list_in(root, "meshes").size(); i++) {
        out.meshes.push_back(take_mesh(path, root, i));
        out.meshes[i].weights =
            take_weights(path, "mesh", i, root["meshes"][i], out.meshes[i].target_count);
    }
    for (size_t i = 0; i < list_in(root, "nodes").size(); i++)
        out.nodes.push_back(take_node(path, root, i, out));
    return out;
}
} // namespace bb_gltf
