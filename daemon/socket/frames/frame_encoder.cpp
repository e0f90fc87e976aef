// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/frames/frame_encoder.h"

#include <new>
#include <span>
#include <stdexcept>
#include <utility>

#include <zstd.h>

namespace disparityd::daemon {
namespace {

/// A part of a plane: `rows` rows of `row_bytes` bytes, `stride` bytes apart.
struct Rectangle {
    const std::uint8_t* data;
    std::size_t row_bytes;
    std::size_t stride;
    std::size_t rows;

    std::size_t size() const { return row_bytes * rows; }

    /// Returns its bytes in place. The rows must be contiguous.
    std::span<const std::uint8_t> span() const { return {data, size()}; }

    void append_to(std::vector<std::uint8_t>& bytes) const {
        for (std::size_t y = 0; y < rows; ++y) {
            bytes.insert(bytes.end(), data + y * stride, data + y * stride + row_bytes);
        }
    }
};

/// Returns what a selection's region cuts out of a plane: all of a record, and all where there is no region.
Selection::Region part_of(const ProductShape& shape, v1::Product product, const Selection::Region& region) {
    const bool all = is_record(product) || region.width == 0;
    return all ? Selection::Region{0, 0, shape.width, shape.height} : region;
}

Rectangle rectangle_of(const FrameCopy& frame, v1::Product product, const Selection::Region& region) {
    const ProductShape& shape = frame.shapes[static_cast<std::size_t>(product)];
    const Selection::Region part = part_of(shape, product, region);
    const std::size_t pixel = shape.bytes_per_pixel;
    const std::size_t stride = shape.width * pixel;
    const std::uint8_t* plane = frame.planes[static_cast<std::size_t>(product)].data();
    return {plane + part.y * stride + part.x * pixel, part.width * pixel, stride, part.height};
}

v1::PlaneInfo plane_info(const FrameCopy& frame, v1::Product product, const Selection::Region& region,
                         v1::Encoding encoding, std::size_t bytes) {
    const ProductShape& shape = frame.shapes[static_cast<std::size_t>(product)];
    const Selection::Region part = part_of(shape, product, region);
    v1::PlaneInfo plane;
    plane.set_product(product);
    plane.set_width(part.width);
    plane.set_height(part.height);
    plane.set_bytes_per_pixel(shape.bytes_per_pixel);
    plane.set_encoding(encoding);
    plane.set_payload_bytes(bytes);
    return plane;
}

EncodedPlanes raw_in_place(const FrameHandle& frame, const Selection& selection, const Selection::Region& region) {
    std::vector<v1::PlaneInfo> planes;
    std::vector<std::span<const std::uint8_t>> parts;
    for (const v1::Product product : selection.products) {
        parts.push_back(rectangle_of(*frame, product, region).span());
        planes.push_back(plane_info(*frame, product, region, v1::RAW, parts.back().size()));
    }
    return {std::move(planes), Payload(std::move(parts), frame)};
}

EncodedPlanes raw_cut(const FrameCopy& frame, const Selection& selection, const Selection::Region& region) {
    std::vector<v1::PlaneInfo> planes;
    std::size_t size = 0;
    for (const v1::Product product : selection.products) {
        const std::size_t bytes = rectangle_of(frame, product, region).size();
        planes.push_back(plane_info(frame, product, region, v1::RAW, bytes));
        size += bytes;
    }
    std::vector<std::uint8_t> bytes;
    bytes.reserve(size);
    for (const v1::Product product : selection.products) {
        rectangle_of(frame, product, region).append_to(bytes);
    }
    return {std::move(planes), Payload(std::move(bytes))};
}

}  // namespace

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

EncodedPlanes FrameEncoder::encode(const FrameHandle& frame, const Selection& selection) {
    const Selection::Region& region = selection.region;
    const bool whole_rows = region.width == 0 || region.width == frame->info.width;
    if (selection.encoding == v1::ZSTD) {
        return compress(*frame, selection, region, whole_rows);
    }
    return whole_rows ? raw_in_place(frame, selection, region) : raw_cut(*frame, selection, region);
}

EncodedPlanes FrameEncoder::compress(const FrameCopy& frame, const Selection& selection,
                                     const Selection::Region& region, bool whole_rows) {
    std::vector<v1::PlaneInfo> planes;
    std::vector<std::uint8_t> bytes;
    std::size_t most = 0;
    for (const v1::Product product : selection.products) {
        most += ZSTD_compressBound(rectangle_of(frame, product, region).size());
    }
    bytes.reserve(most);
    for (const v1::Product product : selection.products) {
        const Rectangle wanted = rectangle_of(frame, product, region);
        if (!whole_rows) {
            cut_.clear();
            wanted.append_to(cut_);
        }
        const std::size_t plane_bytes = compressor_->append(whole_rows ? wanted.span() : cut_, bytes);
        planes.push_back(plane_info(frame, product, region, v1::ZSTD, plane_bytes));
    }
    bytes.shrink_to_fit();  // a client that reads slowly keeps them
    return {std::move(planes), Payload(std::move(bytes))};
}

}  // namespace disparityd::daemon
