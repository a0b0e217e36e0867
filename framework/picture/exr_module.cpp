// EXR through OpenImageIO, which has no C interface: the two functions of exr_module.h. Linear RGB,
// 32-bit float, ZIP.
#include "framework/picture/exr_module.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{

constexpr int side_max = 65536;

void encode(const float *rgb, uint32_t width, uint32_t height, std::vector<unsigned char> &bytes)
{
    OIIO::Filesystem::IOVecOutput sink(bytes);
    std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("picture.exr", &sink);
    if (!output)
        throw std::runtime_error(OIIO::geterror());
    OIIO::ImageSpec spec(static_cast<int>(width), static_cast<int>(height), 3,
                         OIIO::TypeDesc::FLOAT);
    spec.attribute("compression", "zip");
    if (!output->open("picture.exr", spec) || !output->write_image(OIIO::TypeDesc::FLOAT, rgb) ||
        !output->close())
        throw std::runtime_error(output->geterror());
}

std::vector<float> decode(const unsigned char *data, size_t size, uint32_t &width, uint32_t &height)
{
    OIIO::Filesystem::IOMemReader source(const_cast<unsigned char *>(data), size);
    std::unique_ptr<OIIO::ImageInput> input =
        OIIO::ImageInput::open("picture.exr", nullptr, &source);
    if (!input)
        throw std::runtime_error(OIIO::geterror());
    const OIIO::ImageSpec &spec = input->spec();
    if (spec.nchannels < 3 || spec.width < 1 || spec.height < 1 || spec.width > side_max ||
        spec.height > side_max)
        throw std::runtime_error("no RGB picture of a usable size");
    width = static_cast<uint32_t>(spec.width);
    height = static_cast<uint32_t>(spec.height);
    std::vector<float> rgb(3 * static_cast<size_t>(width) * height);
    if (!input->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, rgb.data()))
        throw std::runtime_error(input->geterror());
    return rgb;
}

// A copy that C can free.
void *copied(const void *source, size_t size)
{
    void *copy = std::malloc(size > 0 ? size : 1);
    if (copy == nullptr)
        throw std::bad_alloc();
    std::memcpy(copy, source, size);
    return copy;
}

} // namespace

extern "C" int bb_exr_encode(const float *rgb, uint32_t width, uint32_t height,
                             unsigned char **data, size_t *size, char *message, size_t capacity)
try {
    std::vector<unsigned char> bytes;
    encode(rgb, width, height, bytes);
    *data = static_cast<unsigned char *>(copied(bytes.data(), bytes.size()));
    *size = bytes.size();
    return 0;
} catch (const std::exception &error) {
    std::snprintf(message, capacity, "%s", error.what());
    return 1;
}

extern "C" int bb_exr_decode(const unsigned char *data, size_t size, float **rgb, uint32_t *width,
                             uint32_t *height, char *message, size_t capacity)
try {
    std::vector<float> pixels = decode(data, size, *width, *height);
    *rgb = static_cast<float *>(copied(pixels.data(), pixels.size() * sizeof(float)));
    return 0;
} catch (const std::exception &error) {
    std::snprintf(message, capacity, "%s", error.what());
    return 1;
}
