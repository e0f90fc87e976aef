// SPDX-License-Identifier: Apache-2.0
#include "tests/daemon/socket/pattern_frames.h"

#include <utility>

namespace disparityd::test {
namespace {

/// Rows of the feed are longer than the image, as those of a real source may be.
constexpr std::uint32_t row_padding = 24;
constexpr std::uint32_t record_bytes = 122;

std::uint8_t pattern(std::uint64_t n, v1::Product product, std::uint64_t x, std::uint64_t y) {
    return static_cast<std::uint8_t>(n * 31 + static_cast<std::uint64_t>(product) * 57 + x * 3 + y * 7 + x * y);
}

}  // namespace

std::vector<v1::Product> all_products() {
    std::vector<v1::Product> all;
    for (const proto::ProductFacts& product : proto::products) {
        all.push_back(product.number);
    }
    return all;
}

PatternFrames::PatternFrames(std::uint32_t width, std::uint32_t height, std::vector<v1::Product> products) {
    layout_.geometry.width = width;
    layout_.geometry.height = height;
    layout_.geometry.f = 350.5;
    layout_.geometry.cx = 160.25;
    layout_.geometry.cy = 120.75;
    layout_.geometry.baseline_mm = 120;
    layout_.geometry.disparity_offset = 0.5;
    layout_.geometry.d_min = -16;
    layout_.geometry.disparities = 64;
    layout_.geometry.invalid = -272;
    layout_.geometry.calibration_id = 0xfedcba9876543210;
    layout_.products = std::move(products);
    layout_.shared_memory = "/disparityd.feed";
    layout_.record_bytes.fill(record_bytes);
    for (const v1::Product product : layout_.products) {
        const daemon::ProductShape shape = daemon::product_shape(layout_, product);
        planes_.emplace_back(std::size_t{shape.width * shape.bytes_per_pixel + row_padding} * shape.height);
    }
}

daemon::PublishedFrame PatternFrames::next() {
    daemon::PublishedFrame frame;
    frame.info = layout_.geometry;
    frame.info.publish_index = next_;
    frame.info.sequence = 1000 + next_;
    frame.info.monotonic_ns = static_cast<std::int64_t>(next_) * 1000;
    frame.info.realtime_ns = static_cast<std::int64_t>(next_) * 1000 + 7;
    frame.info.dropped_before = next_ % 3;
    frame.info.flags = v1::DROPPED_BEFORE;
    frame.published = std::chrono::steady_clock::now();
    frame.captured = frame.published - std::chrono::milliseconds(5);
    for (std::size_t i = 0; i < planes_.size(); ++i) {
        const daemon::ProductShape shape = daemon::product_shape(layout_, layout_.products[i]);
        const std::uint32_t row = shape.width * shape.bytes_per_pixel;
        const std::uint32_t stride = row + row_padding;
        for (std::uint32_t y = 0; y < shape.height; ++y) {
            for (std::uint32_t x = 0; x < row; ++x) {
                planes_[i][std::size_t{y} * stride + x] = pattern(next_, layout_.products[i], x, y);
            }
        }
        frame.planes[i] = {planes_[i].data(), static_cast<int>(row), static_cast<int>(shape.height),
                           static_cast<std::ptrdiff_t>(stride)};
    }
    ++next_;
    return frame;
}

std::vector<std::uint8_t> PatternFrames::expected(std::uint64_t n, v1::Product product, std::uint32_t x,
                                                  std::uint32_t y, std::uint32_t width, std::uint32_t height) {
    std::vector<std::uint8_t> bytes;
    if (daemon::is_record(product)) {
        for (std::uint32_t i = 0; i < record_bytes; ++i) {
            bytes.push_back(pattern(n, product, i, 0));
        }
        return bytes;
    }
    const std::uint32_t pixel = proto::product_facts(product).bytes_per_pixel;
    for (std::uint32_t row = y; row < y + height; ++row) {
        for (std::uint32_t column = x * pixel; column < (x + width) * pixel; ++column) {
            bytes.push_back(pattern(n, product, column, row));
        }
    }
    return bytes;
}

}  // namespace disparityd::test
