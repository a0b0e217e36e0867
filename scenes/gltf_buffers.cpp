/* Files and buffers of a glTF file (glTF 2.0 specification, sections 2.8 and 3.6.1).
 *
 * Every size is known before any memory is allocated: that of a file by fstat, that of a data URI
 * from its text. Buffers get exactly byteLength bytes, equal uris are read once, and everything
 * together must fit into three quarters of the host's memory, the limit for scenes.
 */
#include "scenes/gltf_parts.hpp"

extern "C" {
#include "framework/base/file.h"
#include "framework/base/memory.h"
}

#include <tiny_gltf.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <map>
#include <string_view>
#include <strings.h>

namespace bb_gltf
{
namespace
{
using Memory = std::shared_ptr<unsigned char>;

Memory allocate(uint64_t bytes, const std::string &what)
{
    unsigned char *memory = nullptr;
    const bb_status status = bb_host_alloc(nullptr, bytes, what.c_str(), &memory);
    if (status != BB_OK)
        fail(status, "%s", bb_message());
    return Memory(memory, bb_host_free);
}

/* Adds to the bytes that the file needs. */
void add(const std::string &path, uint64_t bytes, uint64_t &total)
{
    const uint64_t limit = bb_host_limit();
    if (bytes > limit - total)
        fail(BB_REFUSED,
             "%s: needs %llu bytes or more with its buffers, three quarters of the host's memory "
             "are %llu: take a smaller scene",
             path.c_str(), static_cast<unsigned long long>(total + bytes),
             static_cast<unsigned long long>(limit));
    total += bytes;
}

class Input
{
  public:
    Input(const std::string &path, const std::string &what) : path_(path), what_(what)
    {
        check(bb_input_open(path_.c_str(), what_.c_str(), &input_));
    }
    ~Input()
    {
        bb_input_close(&input_);
    }
    Input(const Input &) = delete;
    Input &operator=(const Input &) = delete;

    uint64_t size() const
    {
        return input_.size;
    }
    Memory read(uint64_t bytes)
    {
        Memory memory = allocate(bytes, what_ + " " + path_);
        check(bb_input_read(&input_, memory.get(), bytes));
        return memory;
    }

  private:
    static void check(bb_status status)
    {
        if (status != BB_OK)
            fail(status, "%s", bb_message());
    }

    const std::string path_, what_;
    bb_input input_;
};

/* ---- uris ---- */

bool is_hex(char c)
{
    return isxdigit(static_cast<unsigned char>(c)) != 0;
}

/* Reads the byte at `at`, %41 or A, and moves on. */
unsigned char take_byte(std::string_view text, size_t &at)
{
    const auto digit = [&](size_t i) {
        const int c = tolower(static_cast<unsigned char>(text[i]));
        return static_cast<unsigned>(c <= '9' ? c - '0' : c - 'a' + 10);
    };
    if (text[at] == '%' && at + 2 < text.size() && is_hex(text[at + 1]) && is_hex(text[at + 2])) {
        at += 3;
        return static_cast<unsigned char>(digit(at - 2) << 4 | digit(at - 1));
    }
    return static_cast<unsigned char>(text[at++]);
}

/* Length of "scheme:" at the beginning of a uri (RFC 3986, section 3.1), 0 for none. */
size_t scheme_size(const std::string &uri)
{
    size_t i = 0;
    while (i < uri.size() && (isalnum(static_cast<unsigned char>(uri[i])) != 0 ||
                              (i > 0 && strchr("+-.", uri[i]) != nullptr)))
        i++;
    const bool letter = !uri.empty() && isalpha(static_cast<unsigned char>(uri[0])) != 0;
    return letter && i < uri.size() && uri[i] == ':' ? i + 1 : 0;
}

bool is_data(const std::string &uri)
{
    return scheme_size(uri) == 5 && strncasecmp(uri.c_str(), "data:", 5) == 0;
}

/* Returns the path of the file that a uri names, which must be below the folder of the glTF file at
 * `path`. */
std::string file_path(const std::string &path, const BufferRequest &request)
{
    const std::string &uri = *request.uri;
    const auto refuse = [&](const char *why) {
        fail(BB_INVALID, "%s: %s: '%.200s' %s", path.c_str(), request.where.c_str(), uri.c_str(),
             why);
    };
    if (scheme_size(uri) > 0)
        refuse("is not a file: download it and put its name there");
    std::string name;
    for (size_t at = 0; at < uri.size();)
        name += static_cast<char>(take_byte(uri, at));
    if (name.empty())
        refuse("is an empty uri: put the name of a file there");
    if (name.find('\0') != std::string::npos)
        refuse("holds a zero byte");
    if (name[0] == '/')
        refuse("is an absolute path: put the file into the folder of the glTF file");
    for (size_t at = 0, end; at <= name.size(); at = end + 1) {
        end = std::min(name.find('/', at), name.size());
        if (name.compare(at, end - at, "..") == 0)
            refuse("may leave its folder: put the file into the folder of the glTF file");
    }
    const size_t slash = path.rfind('/');
    return (slash == std::string::npos ? "" : path.substr(0, slash + 1)) + name;
}

/* ---- data URIs (RFC 2397) ---- */

struct DataUri {
    std::string_view payload; /* up to the first character that cannot be decoded */
    bool base64;
    uint64_t size; /* decoded */
};

DataUri split_data_uri(const std::string &path, const BufferRequest &request)
{
    const std::string_view uri = *request.uri, mark = ";base64";
    const size_t comma = uri.find(',');
    if (comma == std::string_view::npos)
        fail(BB_INVALID, "%s: %s: its data URI has no comma", path.c_str(), request.where.c_str());
    DataUri out{uri.substr(comma + 1), false, 0};
    out.base64 = comma >= mark.size() && uri.substr(comma - mark.size(), mark.size()) == mark;
    if (out.base64) {
        const char *alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        out.payload = out.payload.substr(0, out.payload.find_first_not_of(alphabet));
        out.size = out.payload.size() / 4 * 3 + std::max<size_t>(out.payload.size() % 4, 1) - 1;
    } else {
        for (size_t at = 0; at < out.payload.size(); out.size++)
            take_byte(out.payload, at);
    }
    return out;
}

/* Decodes piece by piece, since tinygltf copies what it decodes several times. */
void decode_base64(std::string_view payload, uint64_t bytes, unsigned char *to,
                   const std::string &what)
{
    constexpr size_t piece = 1 << 16; /* a multiple of 4 */
    for (uint64_t done = 0; done < bytes; payload.remove_prefix(std::min(piece, payload.size()))) {
        std::vector<unsigned char> out;
        std::string media;
        const std::string uri = "data:application/octet-stream;base64,";
        if (!tinygltf::DecodeDataURI(&out, media, uri + std::string(payload.substr(0, piece)), 0,
                                     false))
            fail(BB_INVALID, "%s: its data URI cannot be decoded", what.c_str());
        const uint64_t size = std::min<uint64_t>(out.size(), bytes - done);
        memcpy(to + done, out.data(), size);
        done += size;
    }
}

Memory decode(const DataUri &data, uint64_t bytes, const std::string &what)
{
    Memory memory = allocate(bytes, what);
    if (data.base64)
        decode_base64(data.payload, bytes, memory.get(), what);
    else
        for (size_t i = 0, at = 0; i < bytes; i++)
            memory.get()[i] = take_byte(data.payload, at);
    return memory;
}

/* ---- all buffers ---- */

/* A source that several buffers may share. */
struct Source {
    const BufferRequest *request; /* the first that names it */
    std::string path;             /* of the file; empty for a data URI */
    uint64_t size;                /* available size */
    uint64_t length = 0;          /* the largest byteLength */
    Memory memory;
};

Source find_source(const std::string &path, const BufferRequest &request)
{
    Source source{&request, {}, 0, 0, nullptr};
    if (is_data(*request.uri)) {
        source.size = split_data_uri(path, request).size;
    } else {
        source.path = file_path(path, request);
        source.size = Input(source.path, path + ": " + request.where + ": file").size();
    }
    return source;
}

void check_size(const std::string &path, const BufferRequest &request, uint64_t size)
{
    if (size < request.length)
        fail(BB_INVALID, "%s: %s is truncated: it has %llu of %llu bytes", path.c_str(),
             request.where.c_str(), static_cast<unsigned long long>(size),
             static_cast<unsigned long long>(request.length));
}

Memory read_source(const std::string &path, const Source &source)
{
    const std::string what = path + ": " + source.request->where;
    if (source.path.empty())
        return decode(split_data_uri(path, *source.request), source.length, what);
    return Input(source.path, what + ": file").read(source.length);
}
} // namespace

Buffer read_file(const std::string &path)
{
    Input input(path, "scene");
    uint64_t total = 0;
    add(path, input.size(), total);
    return {input.read(input.size()), input.size()};
}

std::vector<Buffer> read_buffers(const std::string &path, uint64_t file_size,
                                 const std::vector<BufferRequest> &requests)
{
    std::map<std::string_view, Source> sources;
    uint64_t total = file_size;
    for (const BufferRequest &request : requests) {
        if (request.uri == nullptr) {
            if (request.chunk.data)
                check_size(path, request, request.chunk.size);
            continue;
        }
        auto known = sources.find(*request.uri);
        if (known == sources.end())
            known = sources.emplace(*request.uri, find_source(path, request)).first;
        Source &source = known->second;
        check_size(path, request, source.size);
        if (request.length > source.length) {
            add(path, request.length - source.length, total);
            source.length = request.length;
        }
    }
    std::vector<Buffer> buffers;
    for (const BufferRequest &request : requests) {
        if (request.uri == nullptr) {
            buffers.push_back({request.chunk.data, request.chunk.data ? request.length : 0});
            continue;
        }
        Source &source = sources.at(*request.uri);
        if (!source.memory)
            source.memory = read_source(path, source);
        buffers.push_back({source.memory, request.length});
    }
    return buffers;
}
} // namespace bb_gltf
