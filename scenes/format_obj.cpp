/* Wavefront OBJ: scenes/README.md lists what is read. tinyobjloader parses the lines. It gets only
 * vertices and faces, after their words have been checked, since it silently reads invalid numbers
 * as 0. Polygons become fans, and indices the scene's, here. */
#include "framework/scene/scene.h"

extern "C" {
#include "framework/base/file.h"
#include "framework/base/memory.h"
}

#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstring>
#include <istream>
#include <new>
#include <streambuf>
#include <string>
#include <string_view>
#include <vector>

namespace
{
/* Thrown after bb_fail() has the message; caught at the C interface. */
struct Failure {
    bb_status status;
};

[[noreturn]] void fail(bb_status status, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

[[noreturn]] void fail(bb_status status, const char *format, ...)
{
    char text[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    throw Failure{bb_fail(status, "%s", text)};
}

/* ---- words ---- */

/* As tinyobjloader expects: [sign] digits [. digits] [e [sign] digits], or [sign] . digits. */
bool is_number(std::string_view word)
{
    size_t at = 0;
    const auto sign = [&] { at += at < word.size() && (word[at] == '+' || word[at] == '-'); };
    const auto digits = [&] {
        const size_t end = std::min(word.find_first_not_of("0123456789", at), word.size());
        const size_t count = end - at;
        at = end;
        return count;
    };
    sign();
    size_t count = digits();
    if (at < word.size() && word[at] == '.') {
        at++;
        count += digits();
    }
    if (count == 0)
        return false;
    if (at < word.size() && (word[at] == 'e' || word[at] == 'E')) {
        at++;
        sign();
        const size_t length = digits();
        if (length == 0 || length > 8) /* more is too much for it */
            return false;
    }
    return at == word.size();
}

/* v, v/vt, v//vn or v/vt/vn; only v is used. */
bool is_corner(std::string_view word)
{
    const size_t end = std::min(word.find('/'), word.size());
    const size_t sign = end > 0 && (word[0] == '-' || word[0] == '+');
    const std::string_view digits = word.substr(sign, end - sign);
    return !digits.empty() && digits.size() <= 9 &&
           digits.find_first_not_of("0123456789") == std::string_view::npos &&
           word.find_first_not_of("0123456789+-/", end) == std::string_view::npos;
}

/* Returns the beginning of a word for messages, as ASCII, whatever its encoding. */
std::string quote(std::string_view word)
{
    std::string text(word.substr(0, 40));
    for (char &c : text)
        if (c < ' ' || c > '~')
            c = '?';
    return text;
}

/* ---- lines ---- */

/* The stream that tinyobjloader reads: the file's vertices and faces, line by line. */
class Lines : public std::streambuf
{
  public:
    explicit Lines(const char *path) : path_(path)
    {
        if (const bb_status status = bb_input_open(path, "scene", &input_); status != BB_OK)
            throw Failure{status};
        left_ = input_.size;
    }
    ~Lines() override
    {
        bb_input_close(&input_);
    }
    Lines(const Lines &) = delete;
    Lines &operator=(const Lines &) = delete;

    /* Number of the line that was read last; a continued line has the number of its last part. */
    uint64_t number() const
    {
        return number_;
    }
    uint32_t ignored() const
    {
        return ignored_;
    }

  protected:
    int_type underflow() override
    {
        while (read_line())
            if (is_wanted()) {
                line_ += '\n';
                setg(&line_[0], &line_[0], &line_[0] + line_.size());
                return traits_type::to_int_type(line_[0]);
            }
        return traits_type::eof();
    }

  private:
    int next_byte();
    bool read_line();
    bool is_wanted();
    size_t check_words(std::string_view words, bool (*good)(std::string_view), const char *what,
                       size_t most) const;

    const char *path_;
    bb_input input_ = {};
    uint64_t left_ = 0; /* of the file */
    char block_[1 << 16];
    size_t at_ = 0, end_ = 0; /* of the block */
    std::string line_;
    uint64_t number_ = 0;
    uint32_t ignored_ = 0;
    bool after_return_ = false; /* a line feed that follows is the same end of line */
};

/* Returns -1 at the end. */
int Lines::next_byte()
{
    if (at_ == end_) {
        at_ = 0;
        end_ = static_cast<size_t>(std::min<uint64_t>(sizeof block_, left_));
        if (end_ == 0)
            return -1;
        if (const bb_status status = bb_input_read(&input_, block_, end_); status != BB_OK)
            throw Failure{status};
        left_ -= end_;
    }
    return static_cast<unsigned char>(block_[at_++]);
}

/* Reads a line with any line ending, joined with the lines that a backslash continues; returns
 * false at the end of the file. */
bool Lines::read_line()
{
    line_.clear();
    for (bool any = false;; any = true) {
        const int c = next_byte();
        if (c == '\n' && after_return_) {
            after_return_ = false;
            continue;
        }
        after_return_ = c == '\r';
        if (c == '\n' || c == '\r' || c == -1) {
            if (c == -1 && !any && line_.empty())
                return false;
            number_++;
            if (c == -1 || line_.empty() || line_.back() != '\\')
                return true;
            line_.back() = ' ';
        } else if ((c < ' ' && c != '\t' && c != '\f' && c != '\v') || c == 127) {
            fail(BB_INVALID, "%s: line %llu is no text: the file is not OBJ, or damaged", path_,
                 static_cast<unsigned long long>(number_ + 1));
        } else {
            line_ += static_cast<char>(c);
        }
    }
}

/* Checks the first `most` words; returns their number. */
size_t Lines::check_words(std::string_view words, bool (*good)(std::string_view), const char *what,
                          size_t most) const
{
    const char *const spaces = " \t";
    size_t count = 0, end = 0;
    for (; count < most; count++) {
        const size_t at = words.find_first_not_of(spaces, end);
        if (at == std::string_view::npos)
            break;
        end = std::min(words.find_first_of(spaces, at), words.size());
        const std::string_view word = words.substr(at, end - at);
        if (!good(word))
            fail(BB_INVALID, "%s: line %llu: '%s' is no %s", path_,
                 static_cast<unsigned long long>(number_), quote(word).c_str(), what);
    }
    return count;
}

/* Checks the line, without its comment. */
bool Lines::is_wanted()
{
    if (number_ == 1 && line_.compare(0, 3, "\xef\xbb\xbf") == 0)
        line_.erase(0, 3); /* the byte order mark of UTF-8 */
    line_.resize(std::min(line_.find('#'), line_.size()));
    const std::string_view line = line_;
    const size_t at = std::min(line.find_first_not_of(" \t"), line.size());
    const size_t end = std::min(line.find_first_of(" \t", at), line.size());
    const std::string_view word = line.substr(at, end - at), rest = line.substr(end);
    if (word == "v" && check_words(rest, is_number, "finite number", 3) < 3)
        fail(BB_INVALID, "%s: line %llu: a vertex of fewer than three numbers", path_,
             static_cast<unsigned long long>(number_));
    if (word == "f" && check_words(rest, is_corner, "v, v/vt, v//vn or v/vt/vn", SIZE_MAX) == 0)
        fail(BB_INVALID, "%s: line %llu: a face without corners", path_,
             static_cast<unsigned long long>(number_));
    if (word == "p" || word == "l" || word == "curv" || word == "curv2" || word == "surf")
        ignored_++;
    return word == "v" || word == "f";
}

/* ---- the mesh ---- */

struct Mesh {
    Mesh(const char *of, const Lines &from) : path(of), lines(from)
    {
    }

    const char *path;
    const Lines &lines;
    std::vector<float> vertices;
    std::vector<uint32_t> triangles;
    uint64_t ignored = 0;          /* faces of fewer than three corners */
    int64_t highest = 0;           /* highest index, from 1, that a face names */
    unsigned long long where = 0;  /* line of that index */
    std::vector<uint32_t> corners; /* of the current face */

    unsigned long long line() const
    {
        return lines.number();
    }
    int64_t vertex_count() const
    {
        return static_cast<int64_t>(vertices.size() / 3);
    }
    void check_size() const
    {
        if (4 * (vertices.size() + triangles.size()) > bb_host_limit())
            fail(BB_REFUSED,
                 "%s: needs more than three quarters of the host's memory: take a smaller scene",
                 path);
    }
    void add_vertex(const float (&position)[3]);
    void add_face(const tinyobj::index_t *indices, int count);
};

void Mesh::add_vertex(const float (&position)[3])
{
    for (const float x : position) {
        if (!std::isfinite(x))
            fail(BB_INVALID, "%s: line %llu: vertex %lld is not finite", path, line(),
                 static_cast<long long>(vertex_count() + 1));
        vertices.push_back(x);
    }
    check_size();
}

/* Indices count from 1, or back from the last vertex before the face, which is -1. */
void Mesh::add_face(const tinyobj::index_t *indices, int count)
{
    corners.clear();
    for (int i = 0; i < count; i++) {
        int64_t index = indices[i].vertex_index;
        if (index == 0 || -index > vertex_count())
            fail(BB_INVALID, "%s: line %llu: index %lld names no vertex, there are %lld before it",
                 path, line(), static_cast<long long>(index),
                 static_cast<long long>(vertex_count()));
        if (index < 0)
            index += vertex_count() + 1;
        if (index > highest) {
            highest = index;
            where = line();
        }
        corners.push_back(static_cast<uint32_t>(index - 1));
    }
    ignored += count < 3;
    for (size_t i = 2; i < corners.size(); i++)
        triangles.insert(triangles.end(), {corners[0], corners[i - 1], corners[i]});
    check_size();
}

void take_vertex(void *user, tinyobj::real_t x, tinyobj::real_t y, tinyobj::real_t z,
                 tinyobj::real_t)
{
    static_cast<Mesh *>(user)->add_vertex({x, y, z});
}

void take_face(void *user, tinyobj::index_t *indices, int count)
{
    static_cast<Mesh *>(user)->add_face(indices, count);
}

void read_mesh(Lines &lines, Mesh &mesh)
{
    std::istream stream(&lines);
    stream.exceptions(std::ios::badbit); /* passes on the exceptions of Lines */
    tinyobj::callback_t callbacks;
    callbacks.vertex_cb = take_vertex;
    callbacks.index_cb = take_face;
    std::string error;
    if (!tinyobj::LoadObjWithCallback(stream, callbacks, &mesh, nullptr, nullptr, &error))
        fail(BB_INVALID, "%s: tinyobjloader cannot read it: %s", mesh.path,
             error.substr(0, error.find('\n')).c_str());
    const long long vertices = mesh.vertex_count();
    if (mesh.highest > vertices)
        fail(BB_INVALID, "%s: line %llu: index %lld names no vertex, there are %lld", mesh.path,
             mesh.where, static_cast<long long>(mesh.highest), vertices);
    mesh.ignored += lines.ignored();
    if (lines.number() == 0)
        fail(BB_INVALID, "%s: is empty", mesh.path);
    if (vertices == 0)
        fail(BB_INVALID, "%s: has no vertex", mesh.path);
    if (mesh.triangles.empty() && mesh.ignored == 0)
        fail(BB_INVALID, "%s: holds points only: %lld vertices and no face", mesh.path, vertices);
    if (mesh.triangles.empty())
        fail(BB_INVALID, "%s: holds no face of three corners (%llu points, lines and others)",
             mesh.path, static_cast<unsigned long long>(mesh.ignored));
}

bb_status load(const char *path, const bb_spec *spec, bb_scene *scene)
{
    (void)spec;
    try {
        Lines lines(path);
        Mesh mesh(path, lines);
        read_mesh(lines, mesh);
        BB_TRY(bb_scene_reserve_mesh(scene, mesh.vertices.size() / 3, mesh.triangles.size() / 3));
        memcpy(scene->vertices, mesh.vertices.data(), 4 * mesh.vertices.size());
        memcpy(bb_scene_indices(scene), mesh.triangles.data(), 4 * mesh.triangles.size());
        scene->ignored = static_cast<uint32_t>(std::min<uint64_t>(mesh.ignored, UINT32_MAX));
        return BB_OK;
    } catch (const Failure &failure) {
        return failure.status;
    } catch (const std::bad_alloc &) {
        return bb_fail(BB_REFUSED, "%s: needs more memory than there is", path);
    } catch (const std::exception &error) {
        return bb_fail(BB_INVALID, "%s: cannot be read: %s", path, error.what());
    }
}

const char *const endings[] = {".obj", nullptr};
} // namespace

extern "C" {
extern const bb_scene_format bb_scene_format_obj;
const bb_scene_format bb_scene_format_obj = {"OBJ", endings, load, nullptr};
}
