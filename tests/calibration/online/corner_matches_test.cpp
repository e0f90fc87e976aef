// SPDX-License-Identifier: Apache-2.0
#include "calibration/online/corner_matches.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "calibration/board/corners.h"
#include "calibration/online/epipolar_fit.h"
#include "tests/calibration/online/rectified_pair.h"

namespace disparityd::calibration {
namespace {

/// A texture of smooth waves, seen from `dx`, `dy` further right and down: exact between pixels too.
test::Grey waves(int width, int height, double dx, double dy, double gain = 1) {
    std::mt19937 random(7);
    struct Wave {
        double x, y, phase;
    };
    std::vector<Wave> list;
    for (int i = 0; i < 24; ++i) {
        const auto draw = [&] { return static_cast<double>(random()) / 4294967296.0; };
        list.push_back({1.4 * draw() - 0.7, 1.4 * draw() - 0.7, 6.3 * draw()});
    }
    test::Grey image{width, height, {}};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            double value = 0;
            for (const Wave& wave : list) {
                value += std::sin(wave.x * (x + dx) + wave.y * (y + dy) + wave.phase);
            }
            image.pixels.push_back(static_cast<std::uint8_t>(std::lround(120 + gain * 12 * std::tanh(value / 3) * 8)));
        }
    }
    return image;
}

TEST(Corners, LieInTheirSquaresAwayFromTheEdge) {
    const test::Grey image = waves(200, 120, 0, 0);
    const auto corners = find_corners(image.plane(), 20, 9);
    EXPECT_GT(corners.size(), 40U);
    for (const Pixel corner : corners) {
        EXPECT_GE(corner.x, 9);
        EXPECT_GE(corner.y, 9);
        EXPECT_LT(corner.x, 200 - 9);
        EXPECT_LT(corner.y, 120 - 9);
    }
}

TEST(Corners, AreNotFoundOnAnEdgeNorOnNothing) {
    test::Grey image{64, 48, std::vector<std::uint8_t>(64 * 48, 80)};
    EXPECT_TRUE(find_corners(image.plane(), 16, 4).empty());
    for (int y = 0; y < 48; ++y) {
        std::fill(image.plane().row(y) + 30, image.plane().row(y) + 64, std::uint8_t{200});
    }
    EXPECT_TRUE(find_corners(image.plane(), 16, 4).empty());
    EXPECT_TRUE(find_corners(test::Grey{3, 3, std::vector<std::uint8_t>(9, 1)}.plane(), 16, 4).empty());
}

class Shifted : public testing::TestWithParam<std::pair<double, double>> {};

TEST_P(Shifted, PlacesAreFoundToASmallPartOfAPixel) {
    const auto [dx, dy] = GetParam();
    const test::Grey left = waves(320, 200, 0, 0);
    const test::Grey right = waves(320, 200, dx, dy, 0.8);
    const auto matches = match_corners(left.plane(), right.plane(), {0, 32}, 5);
    EXPECT_GT(matches.size(), 100U);
    std::vector<double> columns;
    std::vector<double> rows;
    for (const CornerMatch& match : matches) {
        columns.push_back(match.left_x - match.right_x);
        rows.push_back(match.left_y - match.right_y);
        EXPECT_NEAR(match.left_x - match.right_x, dx, 0.1);
        EXPECT_NEAR(match.left_y - match.right_y, dy, 0.1);
    }
    EXPECT_NEAR(median(columns), dx, 0.01);
    EXPECT_NEAR(median(rows), dy, 0.01);
}

INSTANTIATE_TEST_SUITE_P(CornerMatches, Shifted,
                         testing::Values(std::pair(7.0, 0.0), std::pair(12.5, -1.25), std::pair(3.3, 2.7),
                                         std::pair(20.75, 0.5)));

TEST(CornerMatches, RepeatedPatternsAreAmbiguousAndLeftOut) {
    test::Grey image{320, 200, {}};
    for (int y = 0; y < 200; ++y) {
        for (int x = 0; x < 320; ++x) {
            image.pixels.push_back((x / 8 + y / 8) % 2 == 0 ? 60 : 180);
        }
    }
    EXPECT_TRUE(match_corners(image.plane(), image.plane(), {0, 48}, 5).empty());
}

TEST(CornerMatches, BeyondTheSearchNothingIsFound) {
    std::mt19937 random(11);
    test::Grey left{320, 200, {}};
    for (int i = 0; i < 320 * 200; ++i) {
        left.pixels.push_back(static_cast<std::uint8_t>(random() >> 24U));
    }
    test::Grey right = left;
    const auto moved = [&](int rows) {
        for (int y = 0; y < 200; ++y) {
            std::copy_n(left.plane().row(std::min(199, y + rows)), 320, right.plane().row(y));
        }
        return match_corners(left.plane(), right.plane(), {-2, 32}, 5).size();
    };
    EXPECT_GT(moved(3), 100U);
    EXPECT_EQ(moved(9), 0U);
}

// Nothing is read beyond the image (a sanitizer sees it), whatever its size.
TEST(CornerMatches, TinyImagesAndRangesWiderThanTheImage) {
    for (const int width : {1, 2, 11, 12, 13, 25, 40}) {
        for (const int height : {1, 9, 12, 13, 27}) {
            const test::Grey image = waves(width, height, 0, 0);
            match_corners(image.plane(), image.plane(), {-64, 128}, 8);
            match_corners(image.plane(), image.plane(), {100, 32}, 3);
        }
    }
}

}  // namespace
}  // namespace disparityd::calibration
