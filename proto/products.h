// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "proto/disparity.pb.h"

/// The products of a frame, as the options of their numbers in disparity.proto say: the build makes the table of them.
/// products/product_planes.h says which plane of the matcher's results each one is.
namespace disparityd::proto {

/// A row: v1::ProductInfo says what the fields mean.
struct ProductFacts {
    v1::Product number;
    std::string_view name;  ///< that of the number in lower case
    std::string_view type;
    std::uint32_t channels;
    std::uint32_t bytes_per_pixel;  ///< all channels together; 0: a record
    std::string_view key;
    std::string_view title;
    std::string_view unit;
    v1::ProductView view;
    double shown_max;
    v1::Product colour_of;
};

/// In the order of their numbers, from 1 without gaps.
inline constexpr auto products = std::to_array<ProductFacts>({
#include "proto/product_rows.inc"
});

/// Throws std::out_of_range for a number that is no product's.
constexpr const ProductFacts& product_facts(v1::Product product) {
    return products.at(static_cast<std::size_t>(product) - 1);
}

/// The name of a product for messages; "product 17" for a number that this program does not know.
inline std::string product_name(std::uint32_t number) {
    return number >= 1 && number <= products.size() ? std::string(products[number - 1].name)
                                                    : "product " + std::to_string(number);
}

/// Returns one line for people: the daemon does not serve the product, and what makes it do so.
inline std::string not_served_text(v1::Product product) {
    const ProductFacts& facts = product_facts(product);
    const std::string_view of_grey =
        facts.colour_of == v1::PRODUCT_NONE ? std::string_view() : product_facts(facts.colour_of).key;
    return "the daemon does not serve the product " + std::string(facts.name) +
           (facts.key.empty() ? "" : ": set " + std::string(facts.key) + " = true in its configuration") +
           (of_grey.empty() ? "" : ", and " + std::string(of_grey) + " = true");
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
