// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/thin_widths.h"

#include <limits>
#include <sstream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace disparityd::eval {
namespace {

constexpr float no_number = std::numeric_limits<float>::infinity();

/// A pole of two columns before a wall, at disparity 20, crossed by a wire of one row at disparity 10.
struct Made {
    int width = 9;
    int height = 7;
    images::FloatMap truth{9, 7, std::vector<float>(63, 5)};
    std::vector<std::uint8_t> thin = std::vector<std::uint8_t>(63, 0);

    Made() {
        for (int i = 0; i < 9; ++i) {
            put(i, 2, 10);
        }
        for (int y = 0; y < 7; ++y) {
            put(3, y, 20);
            put(4, y, 20);
        }
    }
    void put(int x, int y, float disparity) {
        truth.values[static_cast<std::size_t>(9 * y + x)] = disparity;
        thin[static_cast<std::size_t>(9 * y + x)] = 1;
    }
};

TEST(ThinWidths, ThePoleIsTwoWideAndTheWireOneAlsoWhereTheyCross) {
    const Made made;
    images::FloatMap found = made.truth;
    found.values[3] = no_number;  // of the pole
    found.values[4] += 1;         // at most 1 px off
    found.values[9 * 2] -= 1.5F;  // of the wire
    ThinWidths widths;
    widths.add(found, made.truth, made.thin);
    EXPECT_EQ(widths.of(1).pixels, 7U);
    EXPECT_EQ(widths.of(1).found, 6U);
    EXPECT_EQ(widths.of(2).pixels, 14U);
    EXPECT_EQ(widths.of(2).found, 13U);
    EXPECT_EQ(widths.of(0).pixels, 0U);
    widths.add(found, made.truth, made.thin);
    EXPECT_EQ(widths.of(2).pixels, 28U) << "images add up";

    std::ostringstream out;
    print_thin_widths({{"ours", widths}}, false, out);
    EXPECT_THAT(out.str(), testing::HasSubstr("ours found %"));
    EXPECT_THAT(out.str(), testing::ContainsRegex("2 +28 +92.9"));
    const auto json = thin_widths_json({{"ours", widths}});
    ASSERT_EQ(json.size(), 2U) << "widths that do not occur are left out";
    EXPECT_EQ(json[0], nlohmann::ordered_json::parse(R"({"name": "ours", "width": 1, "pixels": 14, "found": 12})"));
}

TEST(ThinWidths, WhatIsWiderThanSixIsCountedApartAndUnknownTruthNot) {
    const images::FloatMap truth{8, 8, std::vector<float>(64, 3)};
    ThinWidths widths;
    widths.add(truth, truth, std::vector<std::uint8_t>(64, 1));
    EXPECT_EQ(widths.of(0).pixels, 64U);
    EXPECT_EQ(widths.of(0).found, 64U);
    ThinWidths unknown;
    unknown.add(truth, {8, 8, std::vector<float>(64, no_number)}, std::vector<std::uint8_t>(64, 1));
    EXPECT_EQ(unknown.of(0).pixels, 0U);
}

TEST(ThinWidths, OtherSizesAreRefused) {
    const images::FloatMap truth{2, 1, {1, 2}};
    ThinWidths widths;
    EXPECT_THROW(widths.add({1, 1, {1}}, truth, {1, 1}), std::invalid_argument);
    EXPECT_THROW(widths.add(truth, truth, {1}), std::invalid_argument);
}

}  // namespace
}  // namespace disparityd::eval
