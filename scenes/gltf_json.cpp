/* From a .gltf or .glb file to a document that tinygltf may be trusted with (glTF 2.0
 * specification, Khronos, chapters 3 to 5).
 *
 * tinygltf 2.7 takes a wrong type for an absent member, narrows 64-bit numbers, reads past a
 * truncated BIN chunk, looks for buffers in the working directory, and recurses over `extras`. So
 * the JSON is parsed here first, and a copy is made of the members that the geometry needs, each
 * one checked; images, materials, animations, skins and extras don't get into it, so that they are
 * neither decoded nor able to do harm. The buffers are read here too.
 */
#include "scenes/gltf_parts.hpp"

#include <nlohmann/json.hpp>
#include <sys/stat.h>
#include <tiny_gltf.h>

#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>

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

/* ---- files ---- */

Bytes read_file(const std::string &path, const std::string &what)
{
    struct stat info;
    if (stat(path.c_str(), &info) != 0)
        fail(BB_INVALID, "%s: %s: check the path", what.c_str(), strerror(errno));
    if (!S_ISREG(info.st_mode))
        fail(BB_INVALID, "%s: is not a regular file", what.c_str());
    std::unique_ptr<FILE, int (*)(FILE *)> file(fopen(path.c_str(), "rb"), fclose);
    if (!file)
        fail(BB_INVALID, "%s: %s", what.c_str(), strerror(errno));
    Bytes bytes(static_cast<size_t>(info.st_size));
    if (fread(bytes.data(), 1, bytes.size(), file.get()) != bytes.size())
        fail(BB_INVALID, "%s: cannot read its %zu bytes", what.c_str(), bytes.size());
    return bytes;
}

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

Container split_glb(const char *path, const Bytes &bytes)
{
    constexpr uint32_t chunk_json = 0x4E4F534Au, chunk_binary = 0x004E4942u;
    if (bytes.size() < 12)
        fail(BB_INVALID, "%s: is truncated: a GLB header has 12 bytes, the file %zu", path,
             bytes.size());
    const uint32_t version = little_endian(&bytes[4]);
    const uint64_t length = little_endian(&bytes[8]);
    if (version != 2)
        fail(BB_INVALID, "%s: is GLB version %u, only version 2 can be read", path, version);
    if (length > bytes.size())
        fail(BB_INVALID, "%s: is truncated: its header says %llu bytes, the file has %zu", path,
             static_cast<unsigned long long>(length), bytes.size());
    Container parts;
    uint64_t at = 12;
    for (uint32_t chunk = 0; at < length; chunk++) {
        if (length - at < 8)
            fail(BB_INVALID, "%s: is truncated in the header of chunk %u", path, chunk);
        const uint64_t size = little_endian(&bytes[at]);
        const uint32_t type = little_endian(&bytes[at + 4]);
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
            parts.text = {bytes.data() + at, static_cast<size_t>(size)};
        else if (is_binary)
            parts.binary = {bytes.data() + at, static_cast<size_t>(size)};
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

    std::string string(const char *key) const
    {
        const json *value = find(key);
        if (value == nullptr)
            return {};
        if (!value->is_string())
            fail(BB_INVALID, "%s: %s: %s is not a string", path_, where.c_str(), key);
        return value->get<std::string>();
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

/* %41 -> A */
std::string decode_percent(const std::string &uri)
{
    std::string out;
    for (size_t i = 0; i < uri.size(); i++) {
        unsigned code;
        if (uri[i] == '%' && i + 2 < uri.size() &&
            isxdigit(static_cast<unsigned char>(uri[i + 1])) &&
            isxdigit(static_cast<unsigned char>(uri[i + 2])) &&
            sscanf(uri.c_str() + i + 1, "%2x", &code) == 1) {
            out += static_cast<char>(code);
            i += 2;
        } else {
            out += uri[i];
        }
    }
    return out;
}

/* Base64, decoded by tinygltf whatever its media type says, or percent-encoded text (RFC 2397). */
Bytes decode_data_uri(const char *path, const std::string &where, const std::string &uri)
{
    const size_t comma = uri.find(',');
    if (comma == std::string::npos)
        fail(BB_INVALID, "%s: %s: its data URI has no comma", path, where.c_str());
    const std::string mark = ";base64", payload = uri.substr(comma + 1);
    Bytes bytes;
    if (comma < mark.size() || uri.compare(comma - mark.size(), mark.size(), mark) != 0) {
        const std::string text = decode_percent(payload);
        bytes.assign(text.begin(), text.end());
        return bytes;
    }
    std::string media;
    if (!tinygltf::DecodeDataURI(&bytes, media, "data:application/octet-stream;base64," + payload,
                                 0, false))
        fail(BB_INVALID, "%s: %s: its data URI holds no data", path, where.c_str());
    return bytes;
}

Bytes read_uri(const std::string &path, const std::string &where, const std::string &uri)
{
    if (uri.compare(0, 5, "data:") == 0)
        return decode_data_uri(path.c_str(), where, uri);
    if (uri.find("://") != std::string::npos)
        fail(BB_INVALID, "%s: %s: '%s' is not a file: download it and put its name there",
             path.c_str(), where.c_str(), uri.c_str());
    const std::string name = decode_percent(uri);
    if (name.find('\0') != std::string::npos)
        fail(BB_INVALID, "%s: %s: its uri holds a zero byte", path.c_str(), where.c_str());
    const size_t slash = path.rfind('/');
    const bool absolute = !name.empty() && name[0] == '/';
    const std::string folder =
        absolute || slash == std::string::npos ? "" : path.substr(0, slash + 1);
    return read_file(folder + name, path + ": " + where + ": file '" + name + "'");
}

/* The bytes of each buffer; a placeholder (no uri, no BIN chunk) stays empty and fails where it is
 * used. */
json read_buffers(const std::string &path, const Object &root, const Span &binary, bool is_glb,
                  Document &document)
{
    json clean = json::array();
    for (const json &value : root.array("buffers")) {
        const size_t number = document.buffers.size();
        const Object buffer(path.c_str(), value, "buffer " + std::to_string(number));
        const uint64_t length = buffer.integer("byteLength", 1, UINT64_MAX);
        Bytes bytes;
        bool present = true;
        if (buffer.has("uri"))
            bytes = read_uri(path, buffer.where, buffer.string("uri"));
        else if (is_glb && number == 0 && binary.data != nullptr)
            bytes.assign(binary.data, binary.data + binary.size);
        else
            present = false;
        if (present && bytes.size() < length)
            fail(BB_INVALID, "%s: %s is truncated: it has %zu of %llu bytes", path.c_str(),
                 buffer.where.c_str(), bytes.size(), static_cast<unsigned long long>(length));
        if (present)
            bytes.resize(static_cast<size_t>(length));
        clean.push_back({{"byteLength", present ? length : 1}, {"uri", std::to_string(number)}});
        document.buffers.push_back(std::move(bytes));
    }
    return clean;
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
            if (view.has_extension(name) && document.buffers[to["buffer"].get<size_t>()].empty())
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
    const Bytes bytes = read_file(path, path);
    if (bytes.empty())
        fail(BB_INVALID, "%s: is empty", path.c_str());
    const size_t magic = std::min<size_t>(bytes.size(), 4);
    const bool is_glb = memcmp(bytes.data(), "glTF", magic) == 0;
    Container parts{{bytes.data(), bytes.size()}, {}};
    if (is_glb)
        parts = split_glb(path.c_str(), bytes);

    const json value = parse(path.c_str(), parts.text);
    const Object root(path.c_str(), value, "the document");
    Document document;
    check_asset(path.c_str(), root);
    document.quantised = check_extensions(path.c_str(), root);

    json clean = {{"asset", {{"version", "2.0"}}}};
    clean["buffers"] = read_buffers(path, root, parts.binary, is_glb, document);
    clean["bufferViews"] = copy_views(path.c_str(), root, document);
    clean["accessors"] = copy_accessors(path.c_str(), root, clean["bufferViews"].size());
    clean["meshes"] = copy_meshes(path.c_str(), root, clean["accessors"]);
    clean["nodes"] = copy_nodes(path.c_str(), root, clean["meshes"].size());
    clean["scenes"] = copy_scenes(path.c_str(), root, clean["nodes"].size());
    document.json = clean.dump(-1, ' ', false, json::error_handler_t::replace);
    return document;
}
} // namespace bb_gltf
