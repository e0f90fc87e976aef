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

/// Returns the bytes of one pixel of a product. Throws std::out_of_range for a number that is no product's.
constexpr std::uint32_t product_bytes(v1::Product product) {
    return proto::product_info(product).bytes_per_pixel;
}

/// Bit of a product in a set of products.
constexpr std::uint32_t product_bit(v1::Product product) {
    return 1U << static_cast<unsigned>(product);
}

/// What every frame of one configuration has in common.
struct StreamLayout {
    proto::FrameInfo geometry{};        ///< its geometry fields; those of a single frame are 0
    std::vector<v1::Product> products;  ///< in the order of their numbers
    std::string shared_memory;          ///< name of the object, empty when off
};

/// One finished frame on its way to the publishers: a view, valid during the call it is passed to.
struct PublishedFrame {
    proto::FrameInfo info{};
    /// One per product of the layout, in its order; width in bytes.
    std::array<Plane<const std::uint8_t>, product_count> planes{};
    std::chrono::steady_clock::time_point captured;   ///< where its age is counted from
    std::chrono::steady_clock::time_point published;  ///< when the pipeline finished it
};

}  // namespace disparityd::daemon
