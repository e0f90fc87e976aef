// SPDX-License-Identifier: Apache-2.0
//
// Masks of the robot's own parts: which pixels a polygon or an image masks, what is refused, what the stage rejects.
#include "obstacles/image_mask.h"

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kernels/near_plane.h"
#include "obstacles/mask_stage.h"

namespace disparityd::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr int mask_width = 40;
constexpr int mask_height = 30;

ImageMask mask_of(const std::vector<std::string>& polygons) {
    return {mask_width, mask_height, polygons, {}, ""};
}

void expect_masked(const ImageMask& mask, const std::function<bool(int x, int y)>& masked) {
    for (int y = 0; y < mask_height; ++y) {
        for (int x = 0; x < mask_width; ++x) {
            ASSERT_EQ(mask.at(x, y), masked(x, y)) << x << ',' << y;
        }
    }
}

/// Returns the line that refuses it.
std::string refusal(const std::string& polygon) {
    try {
        mask_of({polygon});
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "";
}

TEST(ImageMask, MasksTheInsideAndTheEdgesOfPolygons) {
    expect_masked(mask_of({"5,7 12,7 12,20 5,20"}),
                  [](int x, int y) { return x >= 5 && x <= 12 && y >= 7 && y <= 20; });
    expect_masked(mask_of({"0,0 10,0 0,10"}), [](int x, int y) { return x + y <= 10; });
    // Two rows down, one column to the right: pixels on both sides of the edge.
    expect_masked(mask_of({"10,0 20,20 10,20"}),
                  [](int x, int y) { return y <= 20 && x >= 10 && x <= 10 + (y + 1) / 2; });
    expect_masked(mask_of({"39,29 39,0 0,0 0,29"}), [](int, int) { return true; });
}

TEST(ImageMask, AConcavePolygonLeavesItsBayOut) {
    expect_masked(mask_of({"4,4 30,4 30,20 24,20 24,10 10,10 10,20 4,20"}), [](int x, int y) {
        return x >= 4 && x <= 30 && y >= 4 && y <= 20 && (y <= 10 || x <= 10 || x >= 24);
    });
}

TEST(ImageMask, PolygonsAddUp) {
    expect_masked(mask_of({"0,0 1,0 1,1 0,1", "1,1 3,1 3,2 1,2"}),
                  [](int x, int y) { return (x <= 1 && y <= 1) || (x >= 1 && x <= 3 && y >= 1 && y <= 2); });
    EXPECT_TRUE(mask_of({}).empty());
}

TEST(ImageMask, RefusesPolygonsInOneLine) {
    EXPECT_THAT(refusal("1,1 2,2"), AllOf(HasSubstr("\"1,1 2,2\""), HasSubstr("2 corners"), HasSubstr("at least 3")));
    EXPECT_THAT(refusal("1,1 40,2 3,3"), AllOf(HasSubstr("40,2"), HasSubstr("0,0 to 39,29")));
    EXPECT_THAT(refusal("1,1 4,30 3,3"), HasSubstr("4,30"));
    EXPECT_THAT(refusal("-1,1 4,3 3,3"), HasSubstr("-1,1"));
    for (const char* const word : {"4", "4,", ",4", "4,5,6", "4.5,2", "a,b", "4,5x", "99999999999,1"}) {
        EXPECT_THAT(refusal("1,1 " + std::string(word) + " 3,3"), HasSubstr("\"" + std::string(word) + "\""));
    }
    EXPECT_THAT(refusal(""), HasSubstr("0 corners"));
    EXPECT_LT(refusal(std::string(5000, '7')).size(), 6000U);
}

TEST(ImageMask, BlackIsMaskedAndWhiteIsNot) {
    std::vector<std::uint8_t> grey(mask_width * mask_height, 255);
    grey[3 * mask_width + 5] = 0;
    const Plane<const std::uint8_t> image{grey.data(), mask_width, mask_height, mask_width};
    expect_masked(ImageMask(mask_width, mask_height, {}, image, "m.png"),
                  [](int x, int y) { return x == 5 && y == 3; });
    grey[4 * mask_width + 6] = 17;
    try {
        ImageMask(mask_width, mask_height, {}, image, "m.png");
        FAIL() << "17 is taken";
    } catch (const std::invalid_argument& error) {
        EXPECT_THAT(error.what(), AllOf(HasSubstr("m.png"), HasSubstr("17"), HasSubstr("6,4"), HasSubstr("255")));
    }
}

TEST(ImageMask, AnImageOfAnotherSizeIsRefused) {
    const std::vector<std::uint8_t> grey(mask_width * mask_height, 0);
    try {
        ImageMask(mask_width, mask_height, {}, {grey.data(), mask_height, mask_width, mask_height}, "m.png");
        FAIL() << "it is taken";
    } catch (const std::invalid_argument& error) {
        EXPECT_THAT(error.what(), AllOf(HasSubstr("m.png"), HasSubstr("30 x 40"), HasSubstr("40 x 30")));
    }
}

TEST(MaskStage, RejectsMaskedPixelsAndNoOthers) {
    const ImageMask mask = mask_of({"5,7 12,7 12,20 5,20", "39,0 39,29 38,29"});
    MaskStage stage(mask, {.first = -2, .count = 16});
    std::vector<std::int16_t> disparity(mask_width * mask_height, 50);
    std::vector<std::uint8_t> confidence(mask_width * mask_height, 9);
    const int columns = near_blocks(mask_width);
    std::vector<std::int16_t> near(static_cast<std::size_t>(columns * near_blocks(mask_height)), 700);
    FrameView view;
    view.disparity = {disparity.data(), mask_width, mask_height, mask_width};
    view.confidence = {confidence.data(), mask_width, mask_height, mask_width};
    view.near = {near.data(), columns, near_blocks(mask_height), columns};
    Serial serial;
    stage.run({.view = view, .memory = {}, .up = {}}, serial);
    for (int y = 0; y < mask_height; ++y) {
        for (int x = 0; x < mask_width; ++x) {
            ASSERT_EQ(view.disparity.at(x, y), mask.at(x, y) ? -48 : 50) << x << ',' << y;
            ASSERT_EQ(view.confidence.at(x, y), mask.at(x, y) ? 0 : 9) << x << ',' << y;
        }
    }
    for (int row = 0; row < near_blocks(mask_height); ++row) {
        for (int column = 0; column < columns; ++column) {
            bool touched = false;
            for (int i = 0; i < near_block * near_block; ++i) {
                const int x = near_block * column + i % near_block;
                const int y = near_block * row + i / near_block;
                touched = touched || (x < mask_width && y < mask_height && mask.at(x, y));
            }
            ASSERT_EQ(view.near.at(column, row), touched ? not_near : 700) << column << ',' << row;
        }
    }
    view.near = {};
    stage.run({.view = view, .memory = {}, .up = {}}, serial);  // the guard is off
}

}  // namespace
}  // namespace disparityd::test
