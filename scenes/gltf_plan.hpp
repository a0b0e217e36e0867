/* Decides which primitives of a glTF model become triangles, and where in the scene their vertices
 * and triangles are. */
#ifndef BB_GLTF_PLAN_HPP
#define BB_GLTF_PLAN_HPP

#include "scenes/gltf_accessors.hpp"
#include "scenes/gltf_nodes.hpp"

#include <map>

namespace bb_gltf
{
/* One primitive of one node. */
struct Part {
    int node;
    int mesh;
    int primitive;
    int positions; /* accessor */
    uint64_t vertex_base;
    bool shared; /* an earlier part of this node has the same vertices */
    uint64_t triangle_base;
};

/* Counts first, so that all memory is requested at once and can be refused beforehand; then
 * fills. */
class Plan
{
  public:
    /* The primitives of all placed nodes. All three arguments must outlive it. */
    Plan(const char *path, const Document &document, const Accessors &accessors,
         const Placement &placement);

    uint64_t vertex_count() const
    {
        return vertex_count_;
    }
    uint64_t triangle_count() const
    {
        return triangle_count_;
    }
    const std::vector<Part> &parts() const
    {
        return parts_;
    }
    /* Number of primitives left out: points, lines, and those without positions. */
    uint64_t ignored() const
    {
        return no_surface_ + no_positions_;
    }
    std::string name_of(const Part &part) const;

    void fill_triangles(uint32_t *triangles) const;
    /* Computes the vertices of a part in its own pose, moved by its node. `what` names it in
     * messages. */
    void fill_positions(const Part &part, const std::string &what, float *vertices) const;

  private:
    using Bases = std::map<std::vector<int>, uint64_t>;

    const tinygltf::Primitive &primitive_of(const Part &part) const;
    std::vector<int> vertices_of(const Part &part) const;
    void plan_part(const Part &part, Bases &bases);
    uint64_t triangles_of(int mode, uint64_t corners, const std::string &what) const;
    void fill_part(const Part &part, uint32_t *out) const;

    const char *path_;
    const Document &document_;
    const tinygltf::Model &model_;
    const Accessors &accessors_;
    const Placement &placement_;
    std::vector<Part> parts_;
    uint64_t vertex_count_ = 0;
    uint64_t triangle_count_ = 0;
    uint64_t no_surface_ = 0;
    uint64_t no_positions_ = 0;
};
} // namespace bb_gltf

#endif
