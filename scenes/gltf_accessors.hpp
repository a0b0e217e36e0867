/* The accessors of a glTF model: checked, and read element by element. */
#ifndef BB_GLTF_ACCESSORS_HPP
#define BB_GLTF_ACCESSORS_HPP

#include "scenes/gltf_parts.hpp"

#include <functional>

namespace bb_gltf
{
/* `what` names the accessor in messages. All functions fail if data are missing or of a wrong
 * kind. */
class Accessors
{
  public:
    /* Receives an element and its numbers as in the file, a matrix column by column. */
    using Put = std::function<void(uint64_t element, const double *numbers)>;

    /* Kinds of numbers that an accessor may hold. */
    enum Kinds {
        floats = 1,
        whole_numbers = 2,      /* unsigned, of 8 and 16 bits, as they are */
        unsigned_fractions = 4, /* the same, normalized */
        signed_fractions = 8
    };

    Accessors(const char *path, const Document &document) : path_(path), document_(document)
    {
    }

    void check_positions(int accessor, const std::string &what) const;
    void check_indices(int accessor, const std::string &what) const;
    /* `type` is TINYGLTF_TYPE_..., `kinds` are bits, `must` describes both. */
    void check_numbers(int accessor, const std::string &what, int type, unsigned kinds,
                       const char *must) const;
    uint64_t count(int accessor) const;
    /* Returns the number of elements with data in the file: the others are zero. */
    uint64_t given(int accessor) const;
    /* Passes each element once, in no particular order. */
    void read_numbers(int accessor, const std::string &what, const Put &put) const;
    std::vector<uint32_t> read_indices(int accessor, const std::string &what) const;

  private:
    /* The elements of an accessor in memory; data NULL: all zero. */
    struct Elements {
        const unsigned char *data;
        uint64_t count;
        uint64_t stride;
        int component; /* TINYGLTF_COMPONENT_TYPE_... */
    };

    const unsigned char *view_bytes(int view, uint64_t offset, uint64_t count, uint64_t element,
                                    uint64_t *stride, const std::string &what) const;
    Elements elements(int accessor, const std::string &what) const;
    std::vector<uint32_t> sparse_indices(const tinygltf::Accessor &accessor,
                                         const std::string &what) const;

    const char *path_;
    const Document &document_;
};
} // namespace bb_gltf

#endif
