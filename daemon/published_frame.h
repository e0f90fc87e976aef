// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "kernels/image.h"
#include "proto/frame_message.h"
#include "proto/products.h"

namespace disparityd::daemon {

inline constexpr std::size_t product_count = proto::products.size();

/// Bit of a product in a set of products.
constexpr std::uint32_t product_bit(v1::Product product) {
    return 1U << static_cast<unsigned>(product);
}

/// What every frame of one configuration has in common.
struct StreamLayout {
    proto::FrameInfo geometry{};        ///< its geometry fields; those of a single frame are 0
    std::vector<v1::Product> products;  ///< in the order of their numbers
    std::string shared_memory;          ///< name of the object, empty when off
    std::array<std::uint32_t, product_count + 1> record_bytes{};  ///< by number of the product; 0 for images
};

/// The size of a product's plane. A record is a row of bytes.
struct ProductShape {
    std::uint32_t width;
    std::uint32_t height;
    std::uint32_t bytes_per_pixel;

    std::size_t bytes() const { return std::size_t{width} * height * bytes_per_pixel; }
};

constexpr bool is_record(v1::Product product) {
    return proto::product_facts(product).bytes_per_pixel == 0;
}

/// Returns the size of a product's plane in the frames of a layout. Throws std::out_of_range for a number that is no
/// product's.
inline ProductShape product_shape(const StreamLayout& layout, v1::Product product) {
    if (is_record(product)) {
        return {layout.record_bytes[static_cast<std::size_t>(product)], 1, 1};
    }
    return {layout.geometry.width, layout.geometry.height, proto::product_facts(product).bytes_per_pixel};
}

/// One finished frame on its way to the publishers: a view, valid during the call it is passed to.
struct PublishedFrame {
    proto::FrameInfo info{};
    /// One per product of the layout, in its order; width in bytes.
    std::array<Plane<const std::uint8_t>, product_count> planes{};
    std::chrono::steady_clock::time_point captured;   ///< where its age is counted from
    std::chrono::steady_clock::time_point published;  ///< when the pipeline finished it
    std::chrono::steady_clock::time_point taken;      ///< by the pipeline, which had asked whether it is wanted
};

}  // namespace disparityd::daemon
