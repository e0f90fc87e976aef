// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "proto/disparity.pb.h"

/// The products of a frame. The daemon, the tools and the C++ client read this table; a test compares Python's with it.
/// daemon/product_planes.h says which plane of the matcher's results each one is.
namespace disparityd::proto {

struct ProductInfo {
    v1::Product number;
    std::string_view name;  ///< as Python's Frame has it
    /// All channels together; 0: a record that is no image. Its plane is one row of bytes, whatever the region.
    std::uint32_t bytes_per_pixel;
    /// The key of the daemon's configuration that switches it on, "section.name"; empty: the daemon always makes it.
    std::string_view config_key;
};

/// In the order of their numbers, from 1 without gaps.
inline constexpr auto products = std::to_array<ProductInfo>({
    {v1::DISPARITY, "disparity", 2, ""},
    {v1::CONFIDENCE, "confidence", 1, ""},
    {v1::DEPTH, "depth", 2, "match.depth"},
    {v1::LEFT, "left", 1, ""},
    {v1::LEFT_COLOUR, "left_colour", 3, "rectify.colour"},
    {v1::SCAN, "scan", 0, "scan.enabled"},
    {v1::DEPTH_ERROR, "depth_error", 2, "match.depth_error"},
});

/// Throws std::out_of_range for a number that is no product's.
constexpr const ProductInfo& product_info(v1::Product product) {
    return products.at(static_cast<std::size_t>(product) - 1);
}

/// The name of a product for messages; "product 17" for a number that this program does not know.
inline std::string product_name(std::uint32_t number) {
    return number >= 1 && number <= products.size() ? std::string(products[number - 1].name)
                                                    : "product " + std::to_string(number);
}

constexpr bool products_are_numbered() {
    for (std::size_t i = 0; i < products.size(); ++i) {
        if (static_cast<std::size_t>(products[i].number) != i + 1) {
            return false;
        }
    }
    return products.size() == static_cast<std::size_t>(v1::Product_MAX);
}
static_assert(products_are_numbered(), "the table has each product of disparity.proto once, in the order of numbers");

}  // namespace disparityd::proto
