// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "kernels/image.h"
#include "proto/disparity.pb.h"
#include "proto/shared_memory.h"

namespace disparityd {

inline constexpr std::size_t product_count = 5;

/// Bytes of one pixel of a product.
constexpr std::uint32_t product_bytes(v1::Product product) {
    switch (product) {
        case v1::DISPARITY:
        case v1::DEPTH: return 2;
        case v1::LEFT_COLOUR: return 3;
        default: return 1;
    }
}

/// Bit of a product in a set of products.
constexpr std::uint32_t product_bit(v1::Product product) {
    return 1U << static_cast<unsigned>(product);
}

/// What every frame of one configuration has in common.
struct StreamLayout {
    proto::ShmFrame geometry{};         ///< its geometry fields; those of a single frame are 0
    std::vector<v1::Product> products;  ///< in the order of their numbers
    std::string shared_memory;          ///< name of the object, empty when off
};

/// One finished frame on its way to the publishers: a view, valid during the call it is passed to.
struct PublishedFrame {
    proto::ShmFrame info{};
    /// One per product of the layout, in its order; width in bytes.
    std::array<Plane<const std::uint8_t>, product_count> planes{};
    std::chrono::steady_clock::time_point captured;   ///< where its age is counted from
    std::chrono::steady_clock::time_point published;  ///< when the pipeline finished it
};

v1::Geometry to_message(const proto::ShmFrame& geometry);

}  // namespace disparityd
