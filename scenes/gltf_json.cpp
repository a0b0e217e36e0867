/* Makes tinygltf's model from a .gltf or .glb file (glTF 2.0 specification, Khronos, chapters 3 to
 * 5). tinygltf gets the JSON as in the file. Faults that it accepts are refused beforehand;
 * scenes/README.md and tests/test_gltf_faults.cpp list these checks and what tinygltf does without
 * them. */
#include "scenes/gltf_parts.hpp"

#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <strings.h>

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
/* Limit for nested JSON: tinygltf recurses over extras and extensions. */
constexpr int depth_limit = 128;

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

bool is_named_glb(const std::string &path)
{
    return path.size() >= 4 && strcasecmp(path.c_str() + path.size() - 4, ".glb") == 0;
}

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

/* Checks the depth of brackets outside strings. (The parser's own callback would do, but makes it
 * quadratic in the length of arrays.) */
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

/* Says where the text is not JSON. `byte` is the last that was read, from 1. */
[[noreturn]] void refuse_text(const char *path, const Span &text, size_t byte)
{
    const unsigned char *const last = text.data + std::min(byte, text.size);
    size_t line = 1, column = 0;
    for (const unsigned char *c = text.data; c < last; c++) {
        column++;
        if (*c == '\n' && c + 1 < last) {
            line++;
            column = 0;
        }
    }
    if (byte > text.size)
        fail(BB_INVALID, "%s: is not glTF, or truncated: its JSON breaks off in line %zu", path,
             line);
    fail(BB_INVALID, "%s: is not glTF: line %zu, column %zu is not JSON", path, line, column);
}

json parse(const char *path, const Span &text)
{
    check_depth(path, text);
    try {
        json root = json::parse(text.data, text.data + text.size);
        if (!root.is_object())
            fail(BB_INVALID, "%s: is not glTF: its JSON is not an object", path);
        return root;
    } catch (const json::parse_error &error) {
        refuse_text(path, text, error.byte);
    } catch (const json::exception &) {
        fail(BB_INVALID, "%s: is not glTF: its JSON holds a number that is too large", path);
    }
}

/* Returns a list of the object, empty if absent. */
const json &list_in(const json &object, const char *key)
{
    static const json none = json::array();
    const auto found = object.find(key);
    return found != object.end() ? *found : none;
}

/* ---- version and extensions ---- */

std::string text_of(const char *path, const json &object, const char *key)
{
    const auto found = object.find(key);
    if (found == object.end())
        return {};
    if (!found->is_string())
        fail(BB_INVALID, "%s: %s is not a string", path, key);
    return found->get<std::string>();
}

void check_asset(const char *path, const json &root)
{
    const auto asset = root.find("asset");
    if (asset == root.end() || !asset->is_object())
        fail(BB_INVALID, "%s: is not glTF 2.0: it has no asset", path);
    const std::string version = text_of(path, *asset, "version");
    const std::string least = text_of(path, *asset, "minVersion");
    if (version.compare(0, 2, "2.") != 0 || (!least.empty() && least != "2.0"))
        fail(BB_INVALID, "%s: is glTF version '%s', only 2.0 can be read: convert the file", path,
             least.empty() ? version.c_str() : least.c_str());
}

/* Extensions that a file may require and that do not change the triangles: looks, lights, meta
 * data.
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

[[noreturn]] void refuse_extension(const char *path, const std::string &who, const char *name)
{
    fail(BB_UNSUPPORTED,
         "%s: %sneeds the extension %s, which is not supported: save the file without it", path,
         who.c_str(), name);
}

/* Called before tinygltf, which cannot read everything in such a file. */
void check_required_extensions(const char *path, const json &root)
{
    for (const json &name : list_in(root, "extensionsRequired"))
        if (!leaves_geometry_alone(name.get_ref<const std::string &>()))
            refuse_extension(path, "", name.get_ref<const std::string &>().c_str());
}

/* Checks extensions that are not required, but without which there are no data. */
void check_used_extensions(const char *path, const Document &document)
{
    const tinygltf::Model &model = document.model;
    for (size_t i = 0; i < model.bufferViews.size(); i++)
        for (const char *name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
            if (model.bufferViews[i].extensions.count(name) != 0 &&
                !document.buffers[static_cast<size_t>(model.bufferViews[i].buffer)].data)
                refuse_extension(path, "bufferView " + std::to_string(i) + " ", name);
    const char *draco = "KHR_draco_mesh_compression";
    for (size_t i = 0; i < model.meshes.size(); i++)
        for (const tinygltf::Primitive &primitive : model.meshes[i].primitives) {
            const auto position = primitive.attributes.find("POSITION");
            if (primitive.extensions.count(draco) != 0 && position != primitive.attributes.end() &&
                model.accessors[static_cast<size_t>(position->second)].bufferView < 0)
                refuse_extension(path, "mesh " + std::to_string(i) + " ", draco);
        }
}

/* ---- buffers and model ---- */

/* A placeholder (no uri, no BIN chunk) fails where it is used. */
std::vector<BufferRequest> list_buffers(const char *path, const json &root, const Buffer &chunk)
{
    std::vector<BufferRequest> list;
    for (const json &buffer : list_in(root, "buffers")) {
        const std::string where = "buffer " + std::to_string(list.size());
        if (!buffer.contains("byteLength"))
            fail(BB_INVALID, "%s: %s has no byteLength", path, where.c_str());
        const auto uri = buffer.find("uri");
        list.push_back({where, buffer["byteLength"].get<uint64_t>(),
                        uri != buffer.end() ? &uri->get_ref<const std::string &>() : nullptr,
                        list.empty() ? chunk : Buffer()});
    }
    return list;
}

/* Of two members of one name, the last counts: members appended to the document hide those that
 * tinygltf must not read. Buffers are read by gltf_buffers.cpp; the others hold no triangles, but
 * could load other files, or be damaged. */
constexpr const char *hide_the_rest =
    ",\"buffers\":[],\"images\":[],\"textures\":[],\"materials\":[],\"samplers\":[],"
    "\"animations\":[],\"skins\":[],\"cameras\":[],\"extensions\":{},\"extras\":0}";

/* tinygltf refuses indices without a bufferView. They are allowed: zeros, except for a sparse part.
 * It gets a borrowed view, in accessors that hide the document's; `borrowers` must return it. Only
 * these few files are rewritten. */
std::string lend_views(const json &root, std::vector<size_t> &borrowers)
{
    for (const json &mesh : list_in(root, "meshes"))
        for (const json &primitive : list_in(mesh, "primitives"))
            if (primitive.contains("indices") &&
                !root["accessors"][primitive["indices"].get<size_t>()].contains("bufferView"))
                borrowers.push_back(primitive["indices"].get<size_t>());
    if (borrowers.empty())
        return {};
    json accessors = root["accessors"];
    for (const size_t accessor : borrowers)
        accessors[accessor]["bufferView"] = 0;
    const bool has_views = !list_in(root, "bufferViews").empty();
    return ",\"accessors\":" + accessors.dump() +
           (has_views ? "" : ",\"bufferViews\":[{\"buffer\":0,\"byteLength\":1}]");
}

tinygltf::Model read_model(const char *path, const Span &json_text, const json &root)
{
    std::vector<size_t> borrowers;
    std::string text(reinterpret_cast<const char *>(json_text.data), json_text.size);
    text.resize(text.rfind('}')); /* it parsed as an object with an asset: there is one */
    text += lend_views(root, borrowers) + hide_the_rest;
    if (text.size() > INT32_MAX)
        fail(BB_REFUSED, "%s: its JSON is larger than 2 GiB", path);
    tinygltf::Model model;
    tinygltf::TinyGLTF parser;
    std::string error, warning;
    const bool done = parser.LoadASCIIFromString(&model, &error, &warning, text.data(),
                                                 static_cast<unsigned>(text.size()), "");
    /* It continues after some errors, without the affected parts. */
    if (!done || !error.empty())
        fail(BB_INVALID, "%s: tinygltf cannot read it: %s", path,
             error.substr(0, error.find('\n')).c_str());
    for (const size_t accessor : borrowers)
        model.accessors[accessor].bufferView = -1;
    return model;
}
} // namespace

Document read_document(const std::string &path, const char *clip)
{
    const Buffer file = read_file(path);
    if (file.size == 0)
        fail(BB_INVALID, "%s: is empty", path.c_str());
    Container parts{{file.data.get(), file.size}, {}};
    if (memcmp(file.data.get(), "glTF", std::min<uint64_t>(file.size, 4)) == 0)
        parts = split_glb(path.c_str(), parts.text);
    else if (is_named_glb(path))
        fail(BB_INVALID, "%s: is not binary glTF: it does not begin with 'glTF'", path.c_str());
    Buffer chunk;
    if (parts.binary.data != nullptr) /* shares the file's bytes */
        chunk = {std::shared_ptr<const unsigned char>(file.data, parts.binary.data),
                 parts.binary.size};

    const json root = parse(path.c_str(), parts.text);
    Document document;
    check_asset(path.c_str(), root);
    check_schema(path.c_str(), root);
    check_required_extensions(path.c_str(), root);
    document.cameras = find_cameras(root);
    if (clip != nullptr) {
        check_moving_schema(path.c_str(), root);
        document.moving = find_moving(path.c_str(), root, clip);
    }
    document.buffers = read_buffers(path, file.size, list_buffers(path.c_str(), root, chunk));
    document.model = read_model(path.c_str(), parts.text, root);
    const std::vector<std::string> *lists[] = {&document.model.extensionsUsed,
                                               &document.model.extensionsRequired};
    for (const std::vector<std::string> *list : lists)
        document.quantised |=
            std::find(list->begin(), list->end(), "KHR_mesh_quantization") != list->end();
    check_used_extensions(path.c_str(), document);
    return document;
}
} // namespace bb_gltf
