// SPDX-License-Identifier: Apache-2.0
#include "daemon/frame_encoder.h"

#include <cstring>
#include <new>
#include <span>
#include <stdexcept>

#include <zstd.h>

namespace disparityd {

struct FrameEncoder::Compressor {
    ZSTD_CCtx* context = ZSTD_createCCtx();
    Compressor() {
        if (context == nullptr) {
            throw std::bad_alloc();
        }
    }
    ~Compressor() { ZSTD_freeCCtx(context); }
    Compressor(const Compressor&) = delete;
    Compressor& operator=(const Compressor&) = delete;

    /// Appends one zstd frame and returns its size.
    std::size_t append(std::span<const std::uint8_t> from, std::vector<std::uint8_t>& to) {
        const std::size_t before = to.size();
        to.resize(before + ZSTD_compressBound(from.size()));
        const std::size_t written =
            ZSTD_compressCCtx(context, to.data() + before, to.size() - before, from.data(), from.size(), 1);
        if (ZSTD_isError(written) != 0) {
            throw std::runtime_error(std::string("a plane cannot be compressed: zstd: ") + ZSTD_getErrorName(written));
        }
        to.resize(before + written);
        return written;
    }
};

FrameEncoder::FrameEncoder() : compressor_(std::make_unique<Compressor>()) {}
FrameEncoder::~FrameEncoder() = default;

std::uint32_t Selection::product_bits() const {
    std::uint32_t bits = 0;
    for (const v1::Product product : products) {
        bits |= product_bit(product);
    }
    return bits;
}

std::string region_problem(const Selection::Region& region, std::uint32_t width, std::uint32_t height) {
    if (region.width == 0 && region.height == 0) {
        return {};
    }
    const bool inside = region.width > 0 && region.height > 0 && region.x < width && region.y < height &&
                        region.width <= width - region.x && region.height <= height - region.y;
    if (inside) {
        return {};
    }
    return "found x " + std::to_string(region.x) + ", y " + std::to_string(region.y) + ", width " +
           std::to_string(region.width) + ", height " + std::to_string(region.height) +
           ", allowed: at least one pixel, all of it within the image of " + std::to_string(width) + " x " +
           std::to_string(height);
}

EncodedPlanes FrameEncoder::encode(const FrameCopy& frame, const Selection& selection) {
    Selection::Region region = selection.region;
    if (region.width == 0) {
        region = {0, 0, frame.info.width, frame.info.height};
    }
    EncodedPlanes encoded;
    for (const v1::Product product : selection.products) {
        const std::size_t pixel = product_bytes(product);
        const std::size_t row_bytes = region.width * pixel;
        const bool compressed = selection.encoding == v1::ZSTD;
        std::vector<std::uint8_t>& target = compressed ? cut_ : encoded.bytes;
        const std::size_t before = compressed ? 0 : target.size();
        target.resize(before + row_bytes * region.height);
        const std::uint8_t* from = frame.planes[static_cast<std::size_t>(product)].data() +
                                   (std::size_t{region.y} * frame.info.width + region.x) * pixel;
        for (std::uint32_t y = 0; y < region.height; ++y) {
            std::memcpy(target.data() + before + y * row_bytes, from + y * frame.info.width * pixel, row_bytes);
        }
        const std::size_t bytes = compressed ? compressor_->append(cut_, encoded.bytes) : row_bytes * region.height;

        v1::PlaneInfo& plane = encoded.planes.emplace_back();
        plane.set_product(product);
        plane.set_width(region.width);
        plane.set_height(region.height);
        plane.set_bytes_per_pixel(product_bytes(product));
        plane.set_encoding(selection.encoding);
        plane.set_payload_bytes(bytes);
    }
    return encoded;
}

}  // namespace disparityd
