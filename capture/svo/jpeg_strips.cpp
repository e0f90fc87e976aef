// SPDX-License-Identifier: Apache-2.0
#include "capture/svo/jpeg_strips.h"

#include <memory>
#include <new>
#include <stdexcept>

#include <turbojpeg.h>

#include "base/little_endian.h"
#include "capture/recording/recording_format.h"

namespace disparityd::capture {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t most_strips = 16;
constexpr std::size_t size_bytes = 8;

bool begins_as_jpeg(Bytes bytes) {
    return bytes.size() > 3 && bytes[0] == 0xFF && bytes[1] == 0xD8 && bytes[2] == 0xFF;
}

/// Takes the payload apart as `count` JPEGs; nothing where it is none of that.
std::vector<Bytes> split(Bytes payload, std::size_t count) {
    std::vector<Bytes> strips;
    Bytes rest = payload.subspan(count * size_bytes);
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint64_t size = base::get_little_endian(&payload[i * size_bytes], size_bytes);
        if (size > rest.size() || !begins_as_jpeg(rest)) {
            return {};
        }
        strips.push_back(rest.first(static_cast<std::size_t>(size)));
        rest = rest.subspan(static_cast<std::size_t>(size));
    }
    return rest.empty() ? strips : std::vector<Bytes>();
}

struct FreeDecoder {
    void operator()(void* decoder) const { tjDestroy(decoder); }
};

}  // namespace

std::vector<Bytes> jpeg_strips_of(Bytes payload) {
    for (std::size_t count = 1; count <= most_strips && payload.size() > count * size_bytes; ++count) {
        if (auto strips = split(payload, count); !strips.empty()) {
            return strips;
        }
    }
    return {};
}

cv::Mat decode_jpeg_strips(const std::vector<Bytes>& strips) {
    const std::unique_ptr<void, FreeDecoder> decoder(tjInitDecompress());
    if (!decoder) {
        throw std::bad_alloc();
    }
    cv::Mat all;
    for (const Bytes strip : strips) {
        int width = 0, height = 0, subsampling = 0, colours = 0;
        const auto size = static_cast<unsigned long>(strip.size());
        if (tjDecompressHeader3(decoder.get(), strip.data(), size, &width, &height, &subsampling, &colours) != 0) {
            throw std::runtime_error(std::string("a JPEG is damaged: ") + tjGetErrorStr2(decoder.get()));
        }
        if (colours != TJCS_GRAY || (!all.empty() && all.cols != width) || width > recording::max_side ||
            std::int64_t{width} * (std::int64_t{all.rows} + height) > 2 * recording::max_pixels) {
            throw std::runtime_error("its JPEGs are not grey strips of one picture");
        }
        cv::Mat part(height, width, CV_8UC1);
        if (tjDecompress2(decoder.get(), strip.data(), size, part.data, width, width, height, TJPF_GRAY, 0) != 0) {
            throw std::runtime_error(std::string("a JPEG is damaged: ") + tjGetErrorStr2(decoder.get()));
        }
        all.push_back(part);
    }
    return all;
}

}  // namespace disparityd::capture
