// EXR and comparison of images through OpenImageIO, which has no C interface: the functions of
// exr_module.h. 32-bit float, ZIP.
#include "framework/picture/exr_module.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebufalgo.h>
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

OIIO::ImageSpec spec_of(uint32_t width, uint32_t height, uint32_t channel_count)
{
    return OIIO::ImageSpec(static_cast<int>(width), static_cast<int>(height),
                           static_cast<int>(channel_count), OIIO::TypeDesc::FLOAT);
}

void encode(const float *values, const std::string &channels, uint32_t width, uint32_t height,
            std::vector<unsigned char> &bytes)
{
    OIIO::Filesystem::IOVecOutput sink(bytes);
    std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("picture.exr", &sink);
    if (!output)
        throw std::runtime_error(OIIO::geterror());
    OIIO::ImageSpec spec = spec_of(width, height, static_cast<uint32_t>(channels.size()));
    for (size_t i = 0; i < channels.size(); i++)
        spec.channelnames[i] = channels.substr(i, 1);
    spec.attribute("compression", "zip");
    if (!output->open("picture.exr", spec) || !output->write_image(OIIO::TypeDesc::FLOAT, values) ||
        !output->close())
        throw std::runtime_error(output->geterror());
}

std::vector<float> decode(const unsigned char *data, size_t size, const std::string &channels,
                          uint32_t &width, uint32_t &height)
{
    OIIO::Filesystem::IOMemReader source(const_cast<unsigned char *>(data), size);
    std::unique_ptr<OIIO::ImageInput> input =
        OIIO::ImageInput::open("picture.exr", nullptr, &source);
    if (!input)
        throw std::runtime_error(OIIO::geterror());
    const OIIO::ImageSpec &spec = input->spec();
    if (spec.width < 1 || spec.height < 1 || spec.width > side_max || spec.height > side_max)
        throw std::runtime_error("no picture of a usable size");
    width = static_cast<uint32_t>(spec.width);
    height = static_cast<uint32_t>(spec.height);
    const size_t pixels = static_cast<size_t>(width) * height, stride = channels.size();
    std::vector<float> values(stride * pixels);
    for (size_t i = 0; i < stride; i++) {
        const int channel = spec.channelindex(channels.substr(i, 1));
        if (channel < 0)
            throw std::runtime_error("it has no channel " + channels.substr(i, 1));
        if (!input->read_image(0, 0, channel, channel + 1, OIIO::TypeDesc::FLOAT, &values[i],
                               static_cast<OIIO::stride_t>(stride * sizeof(float))))
            throw std::runtime_error(input->geterror());
    }
    return values;
}

bb_exr_difference compare(const float *a, const float *b, uint32_t channel_count, uint32_t width,
                          uint32_t height, float *difference)
{
    const OIIO::ImageSpec spec = spec_of(width, height, channel_count);
    const OIIO::ImageBuf first(spec, const_cast<float *>(a)), second(spec, const_cast<float *>(b));
    const OIIO::ImageBufAlgo::CompareResults found =
        OIIO::ImageBufAlgo::compare(first, second, 0.0f, 0.0f);
    if (difference != nullptr) {
        OIIO::ImageBuf out(spec, difference);
        if (!OIIO::ImageBufAlgo::absdiff(out, first, second))
            throw std::runtime_error(out.geterror());
    }
    return {found.meanerror, found.maxerror, static_cast<uint32_t>(found.maxx),
            static_cast<uint32_t>(found.maxy), static_cast<uint64_t>(found.nfail)};
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

// One line of what the library says.
int failed(const std::exception &error, char *message, size_t capacity)
{
    const std::string text = error.what();
    std::snprintf(message, capacity, "%s", text.substr(0, text.find('\n')).c_str());
    return 1;
}

} // namespace

extern "C" int bb_exr_encode(const float *values, const char *channels, uint32_t width,
                             uint32_t height, unsigned char **data, size_t *size, char *message,
                             size_t capacity)
try {
    std::vector<unsigned char> bytes;
    encode(values, channels, width, height, bytes);
    *data = static_cast<unsigned char *>(copied(bytes.data(), bytes.size()));
    *size = bytes.size();
    return 0;
} catch (const std::exception &error) {
    return failed(error, message, capacity);
}

extern "C" int bb_exr_decode(const unsigned char *data, size_t size, const char *channels,
                             float **values, uint32_t *width, uint32_t *height, char *message,
                             size_t capacity)
try {
    std::vector<float> pixels = decode(data, size, channels, *width, *height);
    *values = static_cast<float *>(copied(pixels.data(), pixels.size() * sizeof(float)));
    return 0;
} catch (const std::exception &error) {
    return failed(error, message, capacity);
}

extern "C" int bb_exr_compare(const float *a, const float *b, uint32_t channel_count,
                              uint32_t width, uint32_t height, float *difference,
                              bb_exr_difference *found, char *message, size_t capacity)
try {
    *found = compare(a, b, channel_count, width, height, difference);
    return 0;
} catch (const std::exception &error) {
    return failed(error, message, capacity);
}
