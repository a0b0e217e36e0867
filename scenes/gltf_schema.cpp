/* Checks that tinygltf lacks, of the members on which the triangles depend: their type, their
 * range, and that their references exist (glTF 2.0 specification, chapter 5). Members that tinygltf
 * itself requires are not required here. Members that move triangles, which are hidden from
 * tinygltf, are only checked if a clip is requested. */
#include "scenes/gltf_parts.hpp"

#include <nlohmann/json.hpp>

namespace bb_gltf
{
namespace
{
using nlohmann::json;

/* An index is a whole number below the length of the document's list `of`. */
enum class Kind { number, text, truth, whole, index, object };

struct Member {
    const char *name;
    Kind kind;
    uint64_t low = 0, high = 0;       /* of a whole number or an index */
    const char *of = nullptr;         /* of objects: name of one of them */
    std::vector<Member> members = {}; /* of an object */
    bool is_list = false;
    uint64_t length = 0; /* of the list; 0: any */
};
using Members = std::vector<Member>;

constexpr uint64_t most = UINT64_MAX, most_int = INT32_MAX; /* tinygltf has size_t and int */

Member whole(const char *name, uint64_t low, uint64_t high)
{
    return {name, Kind::whole, low, high};
}

Member index(const char *name, const char *list)
{
    return {name, Kind::index, 0, most_int, list};
}

Member object(const char *name, const Members &members, const char *of = nullptr)
{
    return {name, Kind::object, 0, 0, of, members};
}

Member list(Member one, uint64_t length = 0)
{
    one.is_list = true;
    one.length = length;
    return one;
}

Member numbers(const char *name, uint64_t length)
{
    return list({name, Kind::number}, length);
}

/* Lists precede those that refer to them. */
Members document_members()
{
    const Members part = {index("bufferView", "bufferViews"), whole("byteOffset", 0, most_int),
                          whole("componentType", 0, most_int)};
    const Members sparse = {whole("count", 1, most_int), object("indices", part),
                            object("values", part)};
    const Members accessor = {index("bufferView", "bufferViews"),
                              whole("byteOffset", 0, most),
                              whole("count", 1, most),
                              {"normalized", Kind::truth},
                              object("sparse", sparse)};
    const Members view = {index("buffer", "buffers"), whole("byteOffset", 0, most),
                          whole("byteLength", 1, most), whole("byteStride", 4, 252)};
    const Members primitive = {object("attributes", {index("POSITION", "accessors")}),
                               index("indices", "accessors"), whole("mode", 0, 6)};
    const Members node = {
        list(index("children", "nodes")), index("mesh", "meshes"), numbers("matrix", 16),
        numbers("translation", 3),        numbers("rotation", 4),  numbers("scale", 3)};
    return {list({"extensionsRequired", Kind::text}),
            list({"extensionsUsed", Kind::text}),
            list(object("buffers", {whole("byteLength", 1, most), {"uri", Kind::text}}, "buffer")),
            list(object("bufferViews", view, "bufferView")),
            list(object("accessors", accessor, "accessor")),
            list(object("meshes", {list(object("primitives", primitive, "primitive"))}, "mesh")),
            list(object("nodes", node, "node")),
            list(object("scenes", {list(index("nodes", "nodes"))}, "scene"))};
}

/* Further members for animations; gltf_moving.cpp requires the mandatory ones. */
Members moving_members()
{
    const Members target = {index("node", "nodes"), {"path", Kind::text}};
    const Members channel = {whole("sampler", 0, most_int), object("target", target)};
    const Members sampler = {
        index("input", "accessors"), index("output", "accessors"), {"interpolation", Kind::text}};
    const Members animation = {{"name", Kind::text},
                               list(object("channels", channel, "channel")),
                               list(object("samplers", sampler, "sampler"))};
    const Members skin = {list(index("joints", "nodes")),
                          index("inverseBindMatrices", "accessors")};
    const Members target_of_mesh = {index("POSITION", "accessors")};
    const Members primitive = {list(object("targets", target_of_mesh, "target"))};
    return {list(object("animations", animation, "animation")), list(object("skins", skin, "skin")),
            list(object("meshes",
                        {numbers("weights", 0), list(object("primitives", primitive, "primitive"))},
                        "mesh")),
            list(object("nodes", {numbers("weights", 0), index("skin", "skins")}, "node"))};
}

struct Checker {
    const char *path;
    const json &root;

    [[noreturn]] void refuse(const std::string &name, const std::string &why) const
    {
        fail(BB_INVALID, "%s: %s is %s", path, name.c_str(), why.c_str());
    }

    void check_whole(const json &value, const std::string &name, const Member &member) const
    {
        const bool good = value.is_number_unsigned();
        const uint64_t n = good ? value.get<uint64_t>() : 0;
        if (!good || n < member.low || n > member.high)
            refuse(name, value.dump(-1, ' ', true, json::error_handler_t::replace).substr(0, 40) +
                             ", must be a whole number from " + std::to_string(member.low) +
                             " to " + std::to_string(member.high));
        const size_t there =
            member.kind == Kind::index && root.contains(member.of) ? root[member.of].size() : 0;
        if (member.kind == Kind::index && n >= there)
            refuse(name, std::to_string(n) + ", but there are " + std::to_string(there) + " " +
                             member.of);
    }

    void check_value(const json &value, const std::string &name, const Member &member) const
    {
        if (member.kind == Kind::object) {
            if (!value.is_object())
                refuse(name, "not a JSON object");
            for (const Member &inner : member.members)
                if (value.contains(inner.name))
                    check(value[inner.name], name, inner);
        } else if (member.kind == Kind::whole || member.kind == Kind::index) {
            check_whole(value, name, member);
        } else if (member.kind == Kind::text && !value.is_string()) {
            refuse(name, "not a string");
        } else if (member.kind == Kind::truth && !value.is_boolean()) {
            refuse(name, "not true or false");
        } else if (member.kind == Kind::number && !value.is_number()) {
            refuse(name, "not " + count_of(member) + "numbers");
        }
    }

    /* Empty for a list of any length. */
    static std::string count_of(const Member &member)
    {
        return member.length != 0 ? std::to_string(member.length) + " " : "";
    }

    /* A member of the object that messages call `owner`; "": of the document. */
    void check(const json &value, const std::string &owner, const Member &member) const
    {
        const bool is_object = member.kind == Kind::object;
        const std::string inside = owner + (owner.empty() ? "" : " ");
        const std::string name = owner + (owner.empty() ? "" : ": ") + member.name;
        if (!member.is_list)
            return check_value(value, is_object ? inside + member.name : name, member);
        if (!value.is_array())
            refuse(name, "not an array");
        if (member.length != 0 && value.size() != member.length)
            refuse(name, "not " + count_of(member) + "numbers");
        for (size_t i = 0; i < value.size(); i++)
            check_value(value[i], is_object ? inside + member.of + " " + std::to_string(i) : name,
                        member);
    }
};

/* tinygltf ignores members beside a matrix. */
void check_transforms(const char *path, const json &nodes)
{
    for (size_t i = 0; i < nodes.size(); i++)
        if (nodes[i].contains("matrix") &&
            (nodes[i].contains("translation") || nodes[i].contains("rotation") ||
             nodes[i].contains("scale")))
            fail(BB_INVALID,
                 "%s: node %zu has a matrix and translation, rotation or scale: one must go", path,
                 i);
}
} // namespace

void check_schema(const char *path, const json &root)
{
    const Checker checker{path, root};
    for (const Member &member : document_members())
        if (root.contains(member.name))
            checker.check(root[member.name], "", member);
    if (root.contains("nodes"))
        check_transforms(path, root["nodes"]);
}

void check_moving_schema(const char *path, const json &root)
{
    const Checker checker{path, root};
    for (const Member &member : moving_members())
        if (root.contains(member.name))
            checker.check(root[member.name], "", member);
}
} // namespace bb_gltf
