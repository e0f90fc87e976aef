// SPDX-License-Identifier: Apache-2.0
#include "products/product_planes.h"

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/configured_products.h"
#include "daemon/published_frame.h"

namespace disparityd::daemon {
namespace {

using testing::Contains;
using testing::Not;

/// A configuration in which the product's key has this value, and that of the picture that it colours is on.
Config with(const proto::ProductFacts& product, bool value) {
    std::vector<Override> sets;
    const auto set = [&sets](std::string_view key, bool on) {
        const std::size_t dot = key.find('.');
        sets.push_back(
            {std::string(key.substr(0, dot)), std::string(key.substr(dot + 1)), on ? "true" : "false", "--set"});
    };
    set(product.key, value);
    if (product.colour_of != v1::PRODUCT_NONE && !proto::product_facts(product.colour_of).key.empty()) {
        set(proto::product_facts(product.colour_of).key, true);
    }
    return parse_config("", "test.toml", sets);
}

TEST(ProductPlanes, KeySwitchesItsProductOn) {
    int switched = 0;
    for (const proto::ProductFacts& product : proto::products) {
        if (product.key.empty()) {
            EXPECT_THAT(configured_products(Config{}), Contains(product.number)) << product.name;
            continue;
        }
        ++switched;
        EXPECT_THAT(configured_products(with(product, true)), Contains(product.number)) << product.name;
        EXPECT_THAT(configured_products(with(product, false)), Not(Contains(product.number))) << product.name;
    }
    EXPECT_GE(switched, 6);
}

TEST(ProductPlanes, EachProductHasAPlaneOfItsSize) {
    constexpr int width = 5;
    constexpr int height = 3;
    std::vector<std::int16_t> disparity(8 * height);
    std::vector<std::uint8_t> confidence(8 * height);
    std::vector<std::uint16_t> depth(8 * height);
    std::vector<std::uint16_t> depth_error(8 * height);
    std::vector<std::uint8_t> left(8 * height);
    std::vector<std::uint8_t> right(8 * height);
    std::vector<std::uint8_t> colour(24 * height);
    std::vector<std::uint8_t> right_colour(24 * height);
    std::vector<std::uint8_t> raw_left(8 * height);
    std::vector<std::uint8_t> raw_right(8 * height);
    FrameView view;
    view.disparity = {disparity.data(), width, height, 8};
    view.confidence = {confidence.data(), width, height, 8};
    view.depth = {depth.data(), width, height, 8};
    view.depth_error = {depth_error.data(), width, height, 8};
    view.left = {left.data(), width, height, 8};
    view.right = {right.data(), width, height, 8};
    view.left_colour = {colour.data(), 3 * width, height, 24};
    view.right_colour = {right_colour.data(), 3 * width, height, 24};
    const pipeline::RawEyes raw{{raw_left.data(), width, height, 8}, {raw_right.data(), width, height, 8}};
    const std::vector<const void*> starts{disparity.data(),    confidence.data(), depth.data(),       left.data(),
                                          colour.data(),       nullptr,           depth_error.data(), right.data(),
                                          right_colour.data(), raw_left.data(),   raw_right.data()};
    for (std::size_t i = 0; i < proto::products.size(); ++i) {
        const proto::ProductFacts& product = proto::products[i];
        const Plane<const std::uint8_t> plane = products::product_plane(view, raw, product.number);
        if (is_record(product.number)) {
            EXPECT_FALSE(plane) << product.name;
            continue;
        }
        const int bytes = static_cast<int>(product.bytes_per_pixel);
        EXPECT_EQ(plane.data, starts[i]) << product.name;
        EXPECT_EQ(plane.width, width * bytes) << product.name;
        EXPECT_EQ(plane.height, height) << product.name;
        EXPECT_EQ(plane.stride, 8 * bytes) << product.name;
    }
}

TEST(ProductPlanes, AnotherNumberIsRefused) {
    EXPECT_THROW(products::product_plane({}, {}, v1::PRODUCT_NONE), std::out_of_range);
    EXPECT_THROW(proto::product_facts(v1::PRODUCT_NONE), std::out_of_range);
    EXPECT_EQ(proto::product_name(3), "depth");
    EXPECT_EQ(proto::product_name(0), "product 0");
    EXPECT_EQ(proto::product_name(99), "product 99");
}

}  // namespace
}  // namespace disparityd::daemon
