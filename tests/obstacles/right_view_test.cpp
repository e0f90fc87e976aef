// SPDX-License-Identifier: Apache-2.0
//
// What the right eye says of pixels that were not measured, on rows that are all alike.
#include "obstacles/right_view.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "obstacles/hiding.h"

namespace disparityd::test {
namespace {

/// Rows of one disparity, in px, with places of other disparities or of none.
class RowPicture {
public:
    static constexpr int width = 320;
    static constexpr int height = 16;
    static constexpr double f = 200;
    static constexpr double baseline_mm = 120;

    /// The distance of a disparity in px.
    static double millimetres(double disparity) { return f * baseline_mm / disparity; }

    explicit RowPicture(int disparity) : disparity_(width * height), confidence_(width * height) {
        put(0, width, disparity, 255);
    }
    RowPicture& thing(int first, int end, int disparity) { return put(first, end, disparity, 255); }
    RowPicture& unmeasured(int first, int end) { return put(first, end, -1, 0); }

    /// What is clear in columns, for an obstacle of 0.1 m and things from 0.2 m on.
    scan::Clear clear(int first, int end) const {
        scan::Geometry geometry(width, height, {});
        geometry.set({width, height, f, (width - 1) / 2.0, (height - 1) / 2.0, {std::lround(16 * f * baseline_mm), 0}});
        scan::RightView view(geometry);
        view.begin({{disparity_.data(), width, height, width}, {confidence_.data(), width, height, width}});
        return view.clear(geometry, 0, first, end);
    }

private:
    RowPicture& put(int first, int end, int disparity, std::uint8_t confidence) {
        for (int y = 0; y < height; ++y) {
            for (int x = first; x < end; ++x) {
                disparity_[static_cast<std::size_t>(y * width + x)] = static_cast<std::int16_t>(16 * disparity);
                confidence_[static_cast<std::size_t>(y * width + x)] = confidence;
            }
        }
        return *this;
    }

    std::vector<std::int16_t> disparity_;
    std::vector<std::uint8_t> confidence_;
};

TEST(RightView, BesideAThingNothingHidesThatIsNearer) {
    // The right eye does not see what is behind 28 columns to the left of the thing.
    RowPicture rows(4);
    rows.thing(200, 260, 32).unmeasured(172, 200);
    const scan::Clear beside = rows.clear(190, 200);
    EXPECT_EQ(beside.from, 0);
    EXPECT_GT(beside.to, 0.6 * RowPicture::millimetres(32));
    EXPECT_LE(beside.to, RowPicture::millimetres(32 - 10)) << "what is so far is hidden from the right eye";
    const scan::Clear farther_aside = rows.clear(176, 186);
    EXPECT_GT(farther_aside.to, beside.to) << "the strip narrows with the distance";
    EXPECT_LE(farther_aside.to, RowPicture::millimetres(32 - 24));
}

TEST(RightView, AThingThatNeitherEyeMeasuresStands) {
    for (const int disparity : {16, 32, 60, 90}) {
        RowPicture rows(4);
        const int end = 200 + static_cast<int>(std::ceil(0.1 * 1000 * disparity / RowPicture::baseline_mm));
        rows.unmeasured(200 - disparity + 4, end);
        for (const int first : {200, (200 + end) / 2, end - 8}) {
            const scan::Clear clear = rows.clear(first, first + 8);
            EXPECT_TRUE(clear.to <= RowPicture::millimetres(disparity) ||
                        clear.from >= RowPicture::millimetres(disparity))
                << disparity << " px, column " << first << ": " << clear.from << " to " << clear.to;
        }
    }
}

TEST(RightView, AThingStandsWhoseMatchesAreWrongInPlaces) {
    RowPicture rows(4);
    rows.unmeasured(172, 260);
    for (int x = 205; x < 260; x += 9) {
        rows.thing(x, x + 2, 5);
    }
    const scan::Clear clear = rows.clear(225, 233);
    EXPECT_TRUE(clear.to <= RowPicture::millimetres(32)) << clear.to;
}

TEST(RightView, KnowsNothingOfWhatItDoesNotSee) {
    // What is nearer than f B / 30 lies outside of the right image, seen from column 30 on.
    RowPicture rows(4);
    rows.unmeasured(20, 30);
    EXPECT_GT(rows.clear(20, 30).from, RowPicture::millimetres(30));
    const scan::Clear without_all = RowPicture(4).unmeasured(0, RowPicture::width).clear(200, 210);
    EXPECT_EQ(without_all.from, 0);
    EXPECT_EQ(without_all.to, 0);
}

TEST(RightView, NoDisparityIsNoProof) {
    // So reads a picture without texture.
    const scan::Clear clear = RowPicture(0).clear(200, 210);
    EXPECT_EQ(clear.to, 0);
}

TEST(Hiding, AnObstacleNeedsRoomInRowsThatAreNotClear) {
    const scan::HidingRoom room{700, 220, 100};
    const std::array falls{-0.3, -0.2, -0.1, 0.0, 0.1};
    const double anywhere = scan::hiding_distance(falls.front(), falls.back(), room, 200);
    EXPECT_DOUBLE_EQ(anywhere, 250) << "0.1 m fills the rows there";
    const scan::Clear far{0, 2000};
    EXPECT_DOUBLE_EQ(scan::hiding_distance(falls, std::array{far, far, far, far}, room, 200), 2000);
    const scan::Clear unknown;
    EXPECT_DOUBLE_EQ(scan::hiding_distance(falls, std::array{unknown, unknown, unknown, unknown}, room, 200), anywhere);
    EXPECT_DOUBLE_EQ(scan::hiding_distance(falls, std::array{far, unknown, unknown, far}, room, 200), 500)
        << "two groups of rows are left";
    EXPECT_DOUBLE_EQ(scan::hiding_distance(falls, std::array{far, unknown, far, far}, room, 200), 1000)
        << "one is left";
    const scan::Clear between{300, 2000};
    EXPECT_DOUBLE_EQ(scan::hiding_distance(falls, std::array{far, between, far, far}, room, 200), anywhere)
        << "nearer than 0.3 m it may stand";
}

}  // namespace
}  // namespace disparityd::test
