/* From a .gltf or .glb file to a document that tinygltf may be trusted with (glTF 2.0
 * specification, Khronos, chapters 3 to 5).
 *
 * tinygltf 2.7 takes a wrong type for an absent member, narrows 64-bit numbers, reads past a
 * truncated BIN chunk, looks for buffers in the working directory, and recurses over `extras`. So
 * the JSON is parsed here first, and a copy is made of the members that the geometry needs, each
 * one checked; images, materials, animations, skins and extras don't get into it, so that they are
 * neither decoded nor able to do harm. Nor do the buffers: gltf_buffers.cpp reads them.
 */
#include "scenes/gltf_parts.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>

namespace bb_gltf
{
using nlohmann::json;

void fail(bb_status status, const char *format, ...)
{
    char text[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    for (char *c = text; *c != '\0'; c++) /* names and quoted JSON come from the file */
        if (static_cast<unsigned char>(*c) < ' ' || *c == 127)
            *c = '?';
    throw Failure{bb_fail(status, "%s", text)};
}

namespace
{
constexpr uint64_t index_limit = INT32_MAX;
constexpr int depth_limit =
    128; /* of nested JSON: a file of nothing but '[' must not eat the memory */

uint32_t little_endian(const unsigned char *bytes)
{
    return bytes[0] | static_cast<uint32_t>(bytes[1]) << 8 | static_cast<uint32_t>(bytes[2]) << 16 |
           static_cast<uint32_t>(bytes[3]) << 24;
}

/* ---- the GLB container (section 4 of the specification) ---- */

struct Span {
    const unsigned char *data = nullptr;
    size_t size = 0;
};

struct Container {
    Span text;
    Span binary;
};

Container split_glb(const char *path, const Span &file)
{
    constexpr uint32_t chunk_json = 0x4E4F534Au, chunk_binary = 0x004E4942u;
    if (file.size < 12)
        fail(BB_INVALID, "%s: is truncated: a GLB header has 12 bytes, the file %zu", path,
             file.size);
    const uint32_t version = little_endian(&file.data[4]);
    const uint64_t length = little_endian(&file.data[8]);
    if (version != 2)
        fail(BB_INVALID, "%s: is GLB version %u, only version 2 can be read", path, version);
    if (length > file.size)
        fail(BB_INVALID, "%s: is truncated: its header says %llu bytes, the file has %zu", path,
             static_cast<unsigned long long>(length), file.size);
    Container parts;
    uint64_t at = 12;
    for (uint32_t chunk = 0; at < length; chunk++) {
        if (length - at < 8)
            fail(BB_INVALID, "%s: is truncated in the header of chunk %u", path, chunk);
        const uint64_t size = little_endian(&file.data[at]);
        const uint32_t type = little_endian(&file.data[at + 4]);
        at += 8;
        if (size > length - at)
            fail(BB_INVALID, "%s: is truncated: chunk %u has %llu bytes, %llu are left", path,
                 chunk, static_cast<unsigned long long>(size),
                 static_cast<unsigned long long>(length - at));
        if (size % 4 != 0)
            fail(BB_INVALID, "%s: the length of chunk %u is not a multiple of 4", path, chunk);
        const bool is_json = type == chunk_json, is_binary = type == chunk_binary;
        if (is_json != (chunk == 0) || (is_binary && chunk != 1))
            fail(BB_INVALID,
                 "%s: chunk %u is out of place: JSON comes first, BIN second, each once", path,
                 chunk);
        if (is_json)
            parts.text = {file.data + at, static_cast<size_t>(size)};
        else if (is_binary)
            parts.binary = {file.data + at, static_cast<size_t>(size)};
        at += size;
    }
    if (parts.text.size == 0)
        fail(BB_INVALID, "%s: holds no JSON: the file is damaged", path);
    return parts;
}

/* ---- JSON ---- */

/* Brackets outside strings. (The parser's own callback would do, but makes it quadratic in the
 * length of arrays.) */
void check_depth(const char *path, const Span &text)
{
    int depth = 0;
    bool quoted = false;
    for (size_t i = 0; i < text.size; i++) {
        const unsigned char c = text.data[i];
        if (quoted && c == '\\')
            i++;
        else if (c == '"')
            quoted = !quoted;
        else if (!quoted && (c == '[' || c == '{'))
            depth++;
        else if (!quoted && (c == ']' || c == '}'))
            depth--;
        if (depth > depth_limit)
            fail(BB_INVALID, "%s: its JSON is nested deeper than %d levels", path, depth_limit);
    }
}

json parse(const char *path, const Span &text)
{
    check_depth(path, text);
    try {
        json root = json::parse(text.data, text.data + text.size);
        if (!root.is_object())
            fail(BB_INVALID, "%s: is not glTF: its JSON is not an object", path);
        return root;
    } catch (const json::exception &error) {
        fail(BB_INVALID, "%s: is not glTF or damaged: %s", path, error.what());
    }
}

/* The members of one JSON object, checked as they are taken. `where` names it in messages. */
class Object
{
  public:
    Object(const char *path, const json &value, std::string name)
        : path_(path), value_(value), where(std::move(name))
    {
        if (!value.is_object())
            fail(BB_INVALID, "%s: %s is not a JSON object", path_, where.c_str());
    }

    const json *find(const char *key) const
    {
        const auto it = value_.find(key);
        return it == value_.end() ? nullptr : &*it;
    }

    bool has(const char *key) const
    {
        return find(key) != nullptr;
    }

    /* A whole number in low..high; absent: `fallback`. */
    uint64_t integer(const char *key, uint64_t low, uint64_t high, uint64_t fallback) const
    {
        return has(key) ? integer(key, low, high) : fallback;
    }

    uint64_t integer(const char *key, uint64_t low, uint64_t high) const
    {
        const json *value = find(key);
        if (value == nullptr)
            fail(BB_INVALID, "%s: %s has no %s", path_, where.c_str(), key);
        return whole(*value, key, low, high);
    }

    /* Copies an optional reference into a list of `count` things. */
    void reference(const char *key, size_t count, json &to) const
    {
        if (has(key))
            to[key] = index(*find(key), key, count);
    }

    uint64_t index(const json &value, const char *key, size_t count) const
    {
        const uint64_t number = whole(value, key, 0, index_limit);
        if (number >= count)
            fail(BB_INVALID, "%s: %s: %s is %llu, but there are %zu", path_, where.c_str(), key,
                 static_cast<unsigned long long>(number), count);
        return number;
    }

    /* Empty if absent. It lives as long as the JSON does. */
    const std::string &string(const char *key) const
    {
        static const std::string none;
        const json *value = find(key);
        if (value != nullptr && !value->is_string())
            fail(BB_INVALID, "%s: %s: %s is not a string", path_, where.c_str(), key);
        return value != nullptr ? value->get_ref<const std::string &>() : none;
    }

    bool boolean(const char *key) const
    {
        const json *value = find(key);
        if (value != nullptr && !value->is_boolean())
            fail(BB_INVALID, "%s: %s: %s is not true or false", path_, where.c_str(), key);
        return value != nullptr && value->get<bool>();
    }

    /* An array, empty if absent. */
    const json &array(const char *key) const
    {
        static const json none = json::array();
        const json *value = find(key);
        if (value != nullptr && !value->is_array())
            fail(BB_INVALID, "%s: %s: %s is not an array", path_, where.c_str(), key);
        return value != nullptr ? *value : none;
    }

    /* Copies an optional array of `count` numbers. */
    void numbers(const char *key, size_t count, json &to) const
    {
        if (!has(key))
            return;
        const json &values = array(key);
        bool good = values.size() == count;
        for (const json &value : values)
            good = good && value.is_number();
        if (!good)
            fail(BB_INVALID, "%s: %s: %s is not %zu numbers", path_, where.c_str(), key, count);
        to[key] = values;
    }

    bool has_extension(const char *name) const
    {
        const json *extensions = find("extensions");
        return extensions != nullptr && extensions->is_object() && extensions->contains(name);
    }

  private:
    uint64_t whole(const json &value, const char *key, uint64_t low, uint64_t high) const
    {
        const bool good = value.is_number_unsigned();
        const uint64_t number = good ? value.get<uint64_t>() : 0;
        if (!good || number < low || number > high)
            fail(BB_INVALID, "%s: %s: %s is %.40s, must be a whole number from %llu to %llu", path_,
                 where.c_str(), key,
                 value.dump(-1, ' ', true, json::error_handler_t::replace).c_str(),
                 static_cast<unsigned long long>(low), static_cast<unsigned long long>(high));
        return number;
    }

    const char *path_;
    const json &value_;

  public:
    const std::string where;
};

/* ---- extensions ---- */

/* Extensions that a file may require and that don't change the triangles: looks, lights, meta data.
 */
bool leaves_geometry_alone(const std::string &name)
{
    static const char *const prefixes[] = {
        "KHR_materials_",  "KHR_texture_",     "EXT_texture_",         "KHR_lights_",
        "EXT_lights_",     "KHR_xmp",          "MSFT_texture_",        "MSFT_packing_",
        "KHR_techniques_", "ADOBE_materials_", "KHR_animation_pointer"};
    for (const char *prefix : prefixes)
        if (name.compare(0, strlen(prefix), prefix) == 0)
            return true;
    return name == "KHR_mesh_quantization";
}

bool check_extensions(const char *path, const Object &root)
{
    bool quantised = false;
    for (const char *list : {"extensionsRequired", "extensionsUsed"})
        for (const json &value : root.array(list)) {
            if (!value.is_string())
                fail(BB_INVALID, "%s: %s holds something that is not a string", path, list);
            const std::string name = value.get<std::string>();
            quantised = quantised || name == "KHR_mesh_quantization";
            if (strcmp(list, "extensionsRequired") == 0 && !leaves_geometry_alone(name))
                fail(BB_UNSUPPORTED,
                     "%s: needs the extension %s, which is not supported: save the file without it",
                     path, name.c_str());
        }
    return quantised;
}

void check_asset(const char *path, const Object &root)
{
    if (!root.has("asset"))
        fail(BB_INVALID, "%s: is not glTF 2.0: it has no asset", path);
    const Object asset(path, *root.find("asset"), "asset");
    const std::string version = asset.string("version"), least = asset.string("minVersion");
    if (version.compare(0, 2, "2.") != 0 || (!least.empty() && least != "2.0"))
        fail(BB_INVALID, "%s: is glTF version '%s', only 2.0 can be read: convert the file", path,
             least.empty() ? version.c_str() : least.c_str());
}

/* ---- buffers ---- */

/* A placeholder (no uri, no BIN chunk) fails where it is used. */
std::vector<BufferRequest> list_buffers(const char *path, const Object &root, const Buffer &chunk)
{
    std::vector<BufferRequest> list;
    for (const json &value : root.array("buffers")) {
        const Object buffer(path, value, "buffer " + std::to_string(list.size()));
        const uint64_t length = buffer.integer("byteLength", 1, UINT64_MAX);
        const std::string *uri = buffer.has("uri") ? &buffer.string("uri") : nullptr;
        list.push_back({buffer.where, length, uri, list.empty() ? chunk : Buffer()});
    }
    return list;
}

/* ---- the checked copy ---- */

json copy_views(const char *path, const Object &root, const Document &document)
{
    json clean = json::array();
    for (const json &value : root.array("bufferViews")) {
        const Object view(path, value, "bufferView " + std::to_string(clean.size()));
        json to = {{"byteOffset", view.integer("byteOffset", 0, UINT64_MAX, 0)},
                   {"byteLength", view.integer("byteLength", 1, UINT64_MAX)}};
        if (!view.has("buffer"))
            fail(BB_INVALID, "%s: %s has no buffer", path, view.where.c_str());
        view.reference("buffer", document.buffers.size(), to);
        if (view.has("byteStride")) {
            const uint64_t stride = view.integer("byteStride", 4, 252);
            if (stride % 4 != 0)
                fail(BB_INVALID, "%s: %s: byteStride is %llu, must be a multiple of 4", path,
                     view.where.c_str(), static_cast<unsigned long long>(stride));
            to["byteStride"] = stride;
        }
        for (const char *name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
            if (view.has_extension(name) && !document.buffers[to["buffer"].get<size_t>()].data)
                fail(BB_UNSUPPORTED,
                     "%s: %s needs the extension %s, which is not supported: save the file without "
                     "it",
                     path, view.where.c_str(), name);
        clean.push_back(std::move(to));
    }
    return clean;
}

json copy_sparse_part(const char *path, const Object &sparse, const char *key, size_t view_count)
{
    if (!sparse.has(key))
        fail(BB_INVALID, "%s: %s has no %s", path, sparse.where.c_str(), key);
    const Object part(path, *sparse.find(key), sparse.where + " " + key);
    json to = {{"byteOffset", part.integer("byteOffset", 0, index_limit, 0)}};
    if (!part.has("bufferView"))
        fail(BB_INVALID, "%s: %s has no bufferView", path, part.where.c_str());
    part.reference("bufferView", view_count, to);
    if (strcmp(key, "indices") == 0)
        to["componentType"] = part.integer("componentType", 5121, 5125);
    return to;
}

json copy_accessors(const char *path, const Object &root, size_t view_count)
{
    json clean = json::array();
    for (const json &value : root.array("accessors")) {
        const Object accessor(path, value, "accessor " + std::to_string(clean.size()));
        json to = {{"byteOffset", accessor.integer("byteOffset", 0, UINT64_MAX, 0)},
                   {"componentType", accessor.integer("componentType", 5120, 5130)},
                   {"count", accessor.integer("count", 1, UINT64_MAX)},
                   {"normalized", accessor.boolean("normalized")}};
        const std::string type = accessor.string("type");
        bool known = false;
        for (const char *name : {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"})
            known = known || type == name;
        if (!known)
            fail(BB_INVALID, "%s: %s: type '%s' is not known", path, accessor.where.c_str(),
                 type.c_str());
        to["type"] = type;
        accessor.reference("bufferView", view_count, to);
        if (accessor.has("sparse")) {
            const Object sparse(path, *accessor.find("sparse"), accessor.where + " sparse");
            to["sparse"] = {{"count", sparse.integer("count", 1, index_limit)},
                            {"indices", copy_sparse_part(path, sparse, "indices", view_count)},
                            {"values", copy_sparse_part(path, sparse, "values", view_count)}};
        }
        clean.push_back(std::move(to));
    }
    return clean;
}

json copy_primitive(const char *path, const Object &primitive, const json &accessors)
{
    json attributes = json::object();
    if (!primitive.has("attributes"))
        fail(BB_INVALID, "%s: %s has no attributes", path, primitive.where.c_str());
    const Object from(path, *primitive.find("attributes"), primitive.where + " attributes");
    from.reference("POSITION", accessors.size(), attributes);
    if (primitive.has("indices"))
        attributes[index_attribute] =
            primitive.index(*primitive.find("indices"), "indices", accessors.size());
    const char *draco = "KHR_draco_mesh_compression";
    if (primitive.has_extension(draco))
        for (const json &accessor : attributes)
            if (!accessors[accessor.get<size_t>()].contains("bufferView"))
                fail(BB_UNSUPPORTED,
                     "%s: %s needs the extension %s, which is not supported: save the file without "
                     "it",
                     path, primitive.where.c_str(), draco);
    return {{"attributes", std::move(attributes)}, {"mode", primitive.integer("mode", 0, 6, 4)}};
}

json copy_meshes(const char *path, const Object &root, const json &accessors)
{
    json clean = json::array();
    for (const json &value : root.array("meshes")) {
        const Object mesh(path, value, "mesh " + std::to_string(clean.size()));
        json primitives = json::array();
        for (const json &part : mesh.array("primitives")) {
            const Object primitive(path, part,
                                   mesh.where + " primitive " + std::to_string(primitives.size()));
            primitives.push_back(copy_primitive(path, primitive, accessors));
        }
        clean.push_back({{"name", mesh.string("name")}, {"primitives", std::move(primitives)}});
    }
    return clean;
}

json copy_list(const Object &object, const char *key, size_t count)
{
    json clean = json::array();
    for (const json &value : object.array(key))
        clean.push_back(object.index(value, key, count));
    return clean;
}

json copy_nodes(const char *path, const Object &root, size_t mesh_count)
{
    json clean = json::array();
    const json &nodes = root.array("nodes");
    for (const json &value : nodes) {
        const Object node(path, value, "node " + std::to_string(clean.size()));
        json to = {{"children", copy_list(node, "children", nodes.size())}};
        node.reference("mesh", mesh_count, to);
        node.numbers("matrix", 16, to);
        node.numbers("translation", 3, to);
        node.numbers("rotation", 4, to);
        node.numbers("scale", 3, to);
        if (node.has("matrix") &&
            (node.has("translation") || node.has("rotation") || node.has("scale")))
            fail(BB_INVALID, "%s: %s has a matrix and translation, rotation or scale: one must go",
                 path, node.where.c_str());
        clean.push_back(std::move(to));
    }
    return clean;
}

json copy_scenes(const char *path, const Object &root, size_t node_count)
{
    json clean = json::array();
    for (const json &value : root.array("scenes")) {
        const Object scene(path, value, "scene " + std::to_string(clean.size()));
        clean.push_back({{"nodes", copy_list(scene, "nodes", node_count)}});
    }
    return clean;
}
} // namespace

Document read_document(const std::string &path)
{
    const Buffer file = read_file(path);
    if (file.size == 0)
        fail(BB_INVALID, "%s: is empty", path.c_str());
    Container parts{{file.data.get(), file.size}, {}};
    if (memcmp(file.data.get(), "glTF", std::min<uint64_t>(file.size, 4)) == 0)
        parts = split_glb(path.c_str(), parts.text);
    Buffer chunk;
    if (parts.binary.data != nullptr) /* shares the file's bytes */
        chunk = {std::shared_ptr<const unsigned char>(file.data, parts.binary.data),
                 parts.binary.size};

    const json value = parse(path.c_str(), parts.text);
    const Object root(path.c_str(), value, "the document");
    Document document;
    check_asset(path.c_str(), root);
    document.quantised = check_extensions(path.c_str(), root);
    document.buffers = read_buffers(path, file.size, list_buffers(path.c_str(), root, chunk));

    json clean = {{"asset", {{"version", "2.0"}}}};
    clean["bufferViews"] = copy_views(path.c_str(), root, document);
    clean["accessors"] = copy_accessors(path.c_str(), root, clean["bufferViews"].size());
    clean["meshes"] = copy_meshes(path.c_str(), root, clean["accessors"]);
    clean["nodes"] = copy_nodes(path.c_str(), root, clean["meshes"].size());
    clean["scenes"] = copy_scenes(path.c_str(), root, clean["nodes"].size());
    document.json = clean.dump(-1, ' ', false, json::error_handler_t::replace);
    return document;
}
} // namespace bb_gltf
