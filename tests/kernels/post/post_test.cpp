// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "kernels/calibrated_confidence.h"
#include "kernels/depth_error.h"
#include "kernels/texture.h"
#include "tests/kernels/support.h"

namespace disparityd::test {
namespace {

constexpr std::int16_t invalid = -16;

cv::Mat view(Image<std::int16_t>& image) {
    return {image.height(), image.width(), CV_16S, image.plane().data};
}

// Smooth enough to have regions, with some rejected pixels.
Image<std::int16_t> disparities(Random& random, int width, int height, int percent_rejected) {
    Image<std::int16_t> image(width, height);
    for (std::int16_t& value : image.pixels()) {
        value = static_cast<std::int16_t>(pick(random, 1, 99) <= percent_rejected ? invalid : pick(random, 0, 5) * 12);
    }
    return image;
}

TEST(LeftRight, AcceptsOneWholePixelOfDisagreement) {
    Image<std::int16_t> left(8, 1, {0, 1, 2, 1, 3, 6, 2, 3});
    Image<std::int16_t> right(8, 1, {1, 4, 1, -1, 3, 9, 9, 9});
    Image<std::int16_t> disparity(8, 1, {5, 16, 32, 17, 50, 96, 40, 48});
    reference::left_right(left.plane(), right.plane(), {0, 16}, disparity.plane(), {0, 1});
    // x - d: 0 (1: ok), 0 (1: ok), 0 (1: ok), 2 (1: ok), 1 (4: ok), -1 (outside), 4 (3: ok), 4 (3: ok)
    EXPECT_EQ(disparity.pixels(), (std::vector<std::int16_t>{5, 16, 32, 17, 50, invalid, 40, 48}));
    right.at(0, 0) = 3;
    right.at(1, 0) = 1;
    reference::left_right(left.plane(), right.plane(), {0, 16}, disparity.plane(), {0, 1});
    EXPECT_EQ(disparity.pixels(), (std::vector<std::int16_t>{invalid, invalid, 32, 17, invalid, invalid, 40, 48}));
}

TEST(LeftRight, NegativeDisparitiesReachTheOtherEnd) {
    Image<std::int16_t> left(3, 1, {-2, -2, -1});
    Image<std::int16_t> right(3, 1, {-4, -4, -1});
    Image<std::int16_t> disparity(3, 1, {-32, -32, -16});
    reference::left_right(left.plane(), right.plane(), {-3, 16}, disparity.plane(), {0, 1});
    // x - d: 2 (-1: ok), 3 (outside), 3 (outside)
    EXPECT_EQ(disparity.pixels(), (std::vector<std::int16_t>{-32, -64, -64}));
}

TEST(LeftRight, ARightPixelWithoutAWinnerAgreesWithNothing) {
    Image<std::int16_t> left(1, 1, 0);
    Image<std::int16_t> right(1, 1, -1);  // the mark of "none" is only one away from the first disparity
    Image<std::int16_t> disparity(1, 1, 0);
    reference::left_right(left.plane(), right.plane(), {0, 16}, disparity.plane(), {0, 1});
    EXPECT_EQ(disparity.at(0, 0), invalid);
}

TEST(Median, EqualsOpenCvWhereNothingIsRejected) {
    Random random(13);
    for (const auto& [width, height] : {std::pair{31, 22}, {1, 1}, {2, 7}, {9, 1}, {3, 3}}) {
        for (const int size : {3, 5}) {
            Image<std::int16_t> in(width, height);
            for (std::int16_t& value : in.pixels()) {
                value = static_cast<std::int16_t>(pick(random, -300, 300));
            }
            Image<std::int16_t> out(width, height, 1234);
            reference::median(in.plane(), -5000, size, out.plane(), out.rows());
            // Only 3 and 5 are done for 16 bit signed.
            cv::Mat expected;
            cv::medianBlur(view(in), expected, size);
            for (int y = 0; y < height; ++y) {
                for (int x = 0; x < width; ++x) {
                    ASSERT_EQ(out.at(x, y), expected.at<std::int16_t>(y, x)) << width << "x" << height << " " << size;
                }
            }
        }
    }
}

TEST(Median, ARejectedNeighbourCountsAsTheCentre) {
    Image<std::int16_t> in(3, 3, {10, 20, 30, invalid, 100, invalid, 40, 200, 210});
    Image<std::int16_t> out(3, 3);
    reference::median(in.plane(), invalid, 3, out.plane(), out.rows());
    // 10 20 30 40 100 100 100 200 210
    EXPECT_EQ(out.at(1, 1), 100);
    EXPECT_EQ(out.at(0, 1), invalid);
    EXPECT_EQ(out.at(2, 1), invalid);
    // The corner, replicated: 10 10 10 10 20 20, and 10 for two rejected, 100.
    EXPECT_EQ(out.at(0, 0), 10);
}

TEST(GuidedMedian, TakesTheLowerMiddleOfSamplesOfLikeIntensity) {
    // Row 2 of five: rejected in the middle of each half, a bright half from column 3 on.
    Image<std::int16_t> in(6, 1, {10, invalid, 30, 70, invalid, 90});
    Image<std::uint8_t> guide(6, 1, {100, 100, 120, 121, 200, 141});
    Image<std::int16_t> out(6, 1, 55);
    reference::guided_median(in.plane(), guide.plane(), invalid, 5, out.plane(), out.rows());
    // Each row of the window is the same, so that one row decides. Column 0: 10 10 10 30, lower middle 10.
    EXPECT_EQ(out.at(0, 0), 10);
    EXPECT_EQ(out.at(1, 0), invalid);
    // Column 2 (120): 10, 30 and 70 (121), not 90.
    EXPECT_EQ(out.at(2, 0), 30);
    // Column 3 (121): 30, 70, 90 (141 is 20 away).
    EXPECT_EQ(out.at(3, 0), 70);
    EXPECT_EQ(out.at(4, 0), invalid);
    // Column 5 (141): 70, and 90 three times.
    EXPECT_EQ(out.at(5, 0), 90);
}

TEST(GuidedMedian, OfAnEvenNumberIsTheLowerOne) {
    Image<std::int16_t> in(2, 1, {40, 20});
    Image<std::uint8_t> guide(2, 1, {7, 7});
    Image<std::int16_t> out(2, 1);
    // Columns of the window of 5: 40 40 40 20 20 and 40 40 20 20 20; of 7: 40 40 40 40 20 20 20 and 40 40 40 20 20
    // 20 20.
    for (const int size : {5, 7}) {
        reference::guided_median(in.plane(), guide.plane(), invalid, size, out.plane(), out.rows());
        EXPECT_EQ(out.at(0, 0), 40);
        EXPECT_EQ(out.at(1, 0), 20);
    }
    Image<std::int16_t> four(4, 1, {40, 30, 20, 10});
    Image<std::uint8_t> edge(4, 1, {7, 7, 28, 28});
    Image<std::int16_t> result(4, 1);
    reference::guided_median(four.plane(), edge.plane(), invalid, 5, result.plane(), result.rows());
    // Column 1: 40 40 30 count (the border once more); column 2: 20 10 10. Column 0: 40 40 40 30.
    EXPECT_EQ(result.pixels(), (std::vector<std::int16_t>{40, 40, 10, 10}));
}

TEST(GuidedMedian, WhereAllCountItIsOpenCvsMedian) {
    Random random(18);
    for (const auto& [width, height] : {std::pair{31, 22}, {1, 1}, {2, 7}, {9, 1}}) {
        Image<std::int16_t> in(width, height);
        for (std::int16_t& value : in.pixels()) {
            value = static_cast<std::int16_t>(pick(random, -300, 300));
        }
        const Image<std::uint8_t> guide = noise(random, width, height, 90, 110);
        Image<std::int16_t> out(width, height, 1234);
        reference::guided_median(in.plane(), guide.plane(), -5000, 5, out.plane(), out.rows());
        cv::Mat expected;
        cv::medianBlur(view(in), expected, 5);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                ASSERT_EQ(out.at(x, y), expected.at<std::int16_t>(y, x)) << width << "x" << height;
            }
        }
    }
}

TEST(Speckle, EqualsOpenCvsFilter) {
    Random random(14);
    for (int round = 0; round < 60; ++round) {
        Image<std::int16_t> image = disparities(random, pick(random, 1, 40), pick(random, 1, 30), 30);
        Image<std::int16_t> expected = image;
        const int size = pick(random, 1, 12);
        const int step = pick(random, 0, 2) * 16;
        // OpenCV rejects regions of up to its size, we those smaller than ours.
        cv::Mat expected_view = view(expected);
        cv::filterSpeckles(expected_view, invalid, size - 1, step);
        std::vector<std::byte> scratch(reference::speckle_scratch(image.width(), image.height()));
        reference::speckle(image.plane(), {invalid, size, step}, scratch);
        ASSERT_EQ(image.pixels(), expected.pixels());
    }
}

TEST(Speckle, DiagonalNeighboursAreApart) {
    Image<std::int16_t> image(3, 3, {16, invalid, invalid, invalid, 16, 16, 32, invalid, 48});
    std::vector<std::byte> scratch(reference::speckle_scratch(3, 3));
    reference::speckle(image.plane(), {invalid, 2, 16}, scratch);
    EXPECT_EQ(image.pixels(),
              (std::vector<std::int16_t>{invalid, invalid, invalid, invalid, 16, 16, invalid, invalid, invalid}));
}

// A region of 8 x 8 pixels whose stripes both eyes see, or the left one alone.
int kept_of(int contrast, bool seen_by_both, int min_texture) {
    constexpr int side = 8;
    Image<std::uint8_t> left(side, side, 100);
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            left.at(x, y) = static_cast<std::uint8_t>(100 + (x / 2 % 2 == 0 ? 0 : contrast));
        }
    }
    const Image<std::uint8_t> right = seen_by_both ? left : Image<std::uint8_t>(side, side, 100);
    Image<std::int16_t> image(side, side, 0);
    std::vector<std::byte> scratch(reference::speckle_scratch(side, side));
    reference::speckle(image.plane(), {invalid, 0, 16, min_texture, left.plane(), right.plane()}, scratch);
    return static_cast<int>(std::count(image.pixels().begin(), image.pixels().end(), std::int16_t{0}));
}

TEST(Texture, ARegionThatBothEyesSeeTextureOnIsKept) {
    EXPECT_EQ(kept_of(40, true, 2), 64);
    EXPECT_EQ(kept_of(40, true, 20), 64);
}

TEST(Texture, ARegionWithoutIsRejectedAlsoWhereItsDisparityIsNotZero) {
    EXPECT_EQ(kept_of(0, true, 2), 0);
    EXPECT_EQ(kept_of(2, true, 2), 0) << "too weak";
    EXPECT_EQ(kept_of(0, true, 0), 64) << "not asked for";
}

TEST(Texture, WhatTheOtherEyeRefutesCountsAgainstARegion) {
    EXPECT_EQ(kept_of(40, false, 2), 0);
}

// A pixel votes when its gradient differs from nothing and from a ramp; the other eye's must be within half of it.
TEST(Texture, AVoteIsThatOfAGradientThatBothEyesSee) {
    EXPECT_EQ(texture_vote(texture_gradient, 0, texture_gradient / 2, 0), 1);
    EXPECT_EQ(texture_vote(texture_gradient, 0, 0, texture_gradient / 2 - 1), -1);
    EXPECT_EQ(texture_vote(-texture_gradient, 0, -texture_gradient, 400), 1);
    EXPECT_EQ(texture_vote(texture_gradient, 0, -texture_gradient, -400), -1);
    EXPECT_EQ(texture_vote(texture_gradient, 0, -400, 400), 1) << "between its neighbours";
    EXPECT_EQ(texture_vote(texture_gradient - 1, 0, texture_gradient, 0), 0) << "too weak";
    EXPECT_EQ(texture_vote(40, 8 * 40, 40, 40), 0) << "a ramp";
    EXPECT_EQ(texture_vote(-1020, 1020, -1020, -1020), 1) << "the steepest there is";
}

TEST(Texture, ARegionNeedsItsShareAndSomeVotes) {
    EXPECT_TRUE(has_texture(texture_votes, 100, 2));
    EXPECT_FALSE(has_texture(texture_votes - 1, 100, 2));
    EXPECT_TRUE(has_texture(100, 5000, 2));
    EXPECT_FALSE(has_texture(99, 5000, 2));
    EXPECT_FALSE(has_texture(-5, 100, 1));
    EXPECT_TRUE(has_texture(1 << 26, 1 << 26, 99)) << "the largest image there is";
}

struct Interpolated {
    Interpolated(Image<std::int16_t> image, const Image<std::int16_t>& right, DisparityRange range)
        : disparity(std::move(image)) {
        std::vector<std::byte> scratch(reference::interpolate_scratch(disparity.width(), disparity.height()),
                                       std::byte{0x33});
        reference::interpolate(disparity.plane(), right.plane(), range, scratch);
    }
    Image<std::int16_t> disparity;
};

TEST(Interpolate, OccludedPixelsGetTheBackgroundOfTheirRow) {
    const Image<std::int16_t> nothing(6, 1, -1);
    EXPECT_EQ(Interpolated({6, 1, {invalid, 80, invalid, invalid, 32, invalid}}, nothing, {0, 16}).disparity.pixels(),
              (std::vector<std::int16_t>{80, 80, 32, 32, 32, 32}));
    EXPECT_EQ(Interpolated({6, 1, std::vector<std::int16_t>(6, invalid)}, nothing, {0, 16}).disparity.pixels(),
              std::vector<std::int16_t>(6, invalid));
}

TEST(Interpolate, MismatchedPixelsGetTheLowerMedianOfEightDirections) {
    Image<std::int16_t> right(5, 5, -1);
    right.at(2, 2) = 0;  // seen by the right image at d = 0 from (2, 2)
    Image<std::int16_t> image(5, 5, {10,      invalid, 20,      invalid, 30,       //
                                     invalid, invalid, invalid, invalid, invalid,  //
                                     40,      invalid, invalid, invalid, 50,       //
                                     invalid, invalid, invalid, invalid, invalid,  //
                                     60,      invalid, 70,      invalid, 80});
    const Interpolated all(image, right, {0, 16});
    EXPECT_EQ(all.disparity.at(2, 2), 40);
    // What is interpolated is no source: its neighbours in the row still see 40 and 50.
    EXPECT_EQ(all.disparity.at(1, 2), 40);
    EXPECT_EQ(all.disparity.at(3, 2), 40);
    EXPECT_EQ(all.disparity.at(1, 0), 10);
    image.at(4, 4) = invalid;
    EXPECT_EQ(Interpolated(image, right, {0, 16}).disparity.at(2, 2), 40);
    image.at(0, 0) = image.at(2, 0) = invalid;
    EXPECT_EQ(Interpolated(image, right, {0, 16}).disparity.at(2, 2), 50);
}

// Step 11 as it is written: each rejected pixel searches by itself.
std::int16_t search(const Image<std::int16_t>& image, const Image<std::int16_t>& right, DisparityRange range,
                    std::int16_t rejected, int x, int y) {
    const auto nearest = [&](int dx, int dy) {
        for (int nx = x + dx, ny = y + dy; nx >= 0 && nx < image.width() && ny >= 0 && ny < image.height();
             nx += dx, ny += dy) {
            if (image.at(nx, ny) != rejected) {
                return image.at(nx, ny);
            }
        }
        return rejected;
    };
    bool mismatched = false;
    for (int d = range.first; d < range.first + range.count; ++d) {
        if (x - d >= 0 && x - d < image.width()) {
            const int back = right.at(x - d, y);
            mismatched = mismatched || (back >= range.first && std::abs(back - d) <= 1);
        }
    }
    std::vector<std::int16_t> values;
    for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
            const bool used = mismatched ? dx != 0 || dy != 0 : dx != 0 && dy == 0;
            if (used && nearest(dx, dy) != rejected) {
                values.push_back(nearest(dx, dy));
            }
        }
    }
    std::sort(values.begin(), values.end());
    return values.empty() ? rejected : mismatched ? values[(values.size() - 1) / 2] : values.front();
}

TEST(Interpolate, EqualsASearchFromEveryPixel) {
    Random random(15);
    for (int round = 0; round < 100; ++round) {
        const DisparityRange range{pick(random, -20, 10), 16};
        const std::int16_t rejected = invalid_disparity(range);
        const int width = pick(random, 1, 25);
        const int height = pick(random, 1, 20);
        Image<std::int16_t> image(width, height);
        Image<std::int16_t> right(width, height);
        const int percent = pick(random, 5, 100);
        for (std::size_t i = 0; i < image.pixels().size(); ++i) {
            const bool gone = pick(random, 1, 100) <= percent;
            image.pixels()[i] = gone ? rejected : static_cast<std::int16_t>(16 * range.first + pick(random, 0, 250));
            right.pixels()[i] = static_cast<std::int16_t>(range.first - 1 + pick(random, 0, 3) * pick(random, 0, 5));
        }
        const Interpolated found(image, right, range);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const std::int16_t expected =
                    image.at(x, y) != rejected ? image.at(x, y) : search(image, right, range, rejected, x, y);
                ASSERT_EQ(found.disparity.at(x, y), expected) << x << "," << y;
            }
        }
    }
}

TEST(FinishConfidence, IsZeroExactlyWhereRejected) {
    Image<std::int16_t> disparity(3, 1, {invalid, 0, 40});
    Image<std::uint8_t> confidence(3, 1, {200, 1, 255});
    reference::finish_confidence(disparity.plane(), invalid, false, confidence.plane(), {0, 1});
    EXPECT_EQ(confidence.pixels(), (std::vector<std::uint8_t>{0, 1, 255}));
}

// By hand: 161 at a ratio of 0 and 175 at 16, 205 at 80 and 214 at 96, 253 at 240 and 256.
TEST(FinishConfidence, IsTheChanceThatTheRatioStandsForWhereCalibrated) {
    Image<std::int16_t> disparity(7, 1, {invalid, 0, 0, 0, 0, 0, 0});
    Image<std::uint8_t> confidence(7, 1, {200, 0, 16, 8, 1, 84, 255});
    reference::finish_confidence(disparity.plane(), invalid, true, confidence.plane(), {0, 1});
    EXPECT_EQ(confidence.pixels(), (std::vector<std::uint8_t>{0, 161, 175, 168, 162, 207, 253}));
}

TEST(FinishConfidence, AHigherRatioIsNeverALowerChance) {
    for (int ratio = 1; ratio < 256; ++ratio) {
        EXPECT_GE(calibrated_confidence(static_cast<std::uint8_t>(ratio)),
                  calibrated_confidence(static_cast<std::uint8_t>(ratio - 1)));
    }
}

std::uint16_t depth_of(std::int16_t disparity, DepthScale scale) {
    Image<std::int16_t> in(1, 1, disparity);
    Image<std::uint16_t> out(1, 1, 4321);
    reference::depth(in.plane(), invalid, scale, out.plane(), {0, 1});
    return out.at(0, 0);
}

TEST(Depth, IsRoundedMillimetres) {
    // f = 350 px, B = 120 mm: K = 672000
    EXPECT_EQ(depth_of(160, {672000, 0}), 4200);
    EXPECT_EQ(depth_of(161, {672000, 0}), 4174);  // 4173.91
    EXPECT_EQ(depth_of(163, {672000, 0}), 4123);  // 4122.70
    EXPECT_EQ(depth_of(150, {672000, 10}), 4200);
    EXPECT_EQ(depth_of(-8, {672000, 168}), 4200);
    EXPECT_EQ(depth_of(2, {5, 0}), 3);  // 2.5
}

TEST(Depth, FarIsNeverUnknownAndUnknownNeverFar) {
    EXPECT_EQ(depth_of(invalid, {672000, 0}), 0);
    EXPECT_EQ(depth_of(160, {0, 0}), 0);
    EXPECT_EQ(depth_of(0, {672000, 0}), 65535);
    EXPECT_EQ(depth_of(-5, {672000, 0}), 65535);
    EXPECT_EQ(depth_of(10, {672000, 0}), 65535);  // 67200 mm
    EXPECT_EQ(depth_of(1, {65534, 0}), 65534);
    EXPECT_EQ(depth_of(1, {65535, 0}), 65535);
    EXPECT_EQ(depth_of(4000, {1000, 0}), 1);  // nearer than half a millimetre is still known
    EXPECT_EQ(depth_of(1, {std::int64_t{1} << 50, 0}), 65535);
}

std::uint16_t error_of(std::int16_t disparity, DepthScale scale, int subpixel_error, std::uint8_t confidence = 200) {
    Image<std::int16_t> in(1, 1, disparity);
    Image<std::uint8_t> measured(1, 1, confidence);
    Image<std::uint16_t> out(1, 1, 4321);
    reference::depth_error(in.plane(), measured.plane(), depth_error_scale(scale.k, scale.offset16, subpixel_error),
                           out.plane(), {0, 1});
    return out.at(0, 0);
}

TEST(DepthError, IsRoundedMillimetres) {
    // f = 350 px, B = 120 mm: K = 672000. A disparity of 10 px is 4200 mm, an error of 1/4 px a 40th of it.
    EXPECT_EQ(error_of(160, {672000, 0}, 64), 105);
    EXPECT_EQ(error_of(161, {672000, 0}, 64), 104);  // 103.70
    EXPECT_EQ(error_of(163, {672000, 0}, 64), 101);  // 101.17
    EXPECT_EQ(error_of(150, {672000, 10}, 64), 105);
    EXPECT_EQ(error_of(-8, {672000, 168}, 64), 105);
    EXPECT_EQ(error_of(160, {672000, 0}, 256), 420);
    EXPECT_EQ(error_of(2, {10, 0}, 16), 3);  // 2.5
    EXPECT_EQ(error_of(1, {5, 0}, 8), 3);    // K s / 16 is 2.5 and counts as 3
}

// The error of the depth is what moving the disparity by its error changes.
TEST(DepthError, IsTheChangeOfDepthWithTheDisparity) {
    constexpr DepthScale scale{100000000, 0};
    for (const int n : {2000, 3000, 5000, 8000}) {
        const auto depth = [&](int d16) { return depth_of(static_cast<std::int16_t>(d16), scale); };
        const double change = (depth(n - 8) - depth(n + 8)) / 2.0;  // 8/16 px
        EXPECT_NEAR(error_of(static_cast<std::int16_t>(n), scale, 128), change, 1.5) << n;
    }
}

TEST(DepthError, UnknownIsWhatWasNotMeasured) {
    EXPECT_EQ(error_of(160, {672000, 0}, 64, 0), 0);
    EXPECT_EQ(error_of(0, {672000, 0}, 64, 0), 0);
    EXPECT_EQ(error_of(160, {0, 0}, 64), 0);
    EXPECT_EQ(error_of(160, {-672000, 0}, 64), 0);
}

TEST(DepthError, KnownIsNeverUnknownAndLargeNeverWraps) {
    EXPECT_EQ(error_of(0, {672000, 0}, 64), 65535);
    EXPECT_EQ(error_of(-5, {672000, 0}, 64), 65535);
    EXPECT_EQ(error_of(6, {672000, 0}, 64), 65535);  // 74667 mm
    EXPECT_EQ(error_of(4000, {672000, 0}, 64), 1);   // a sixth of a millimetre is still known
    EXPECT_EQ(error_of(1, {65534, 0}, 16), 65534);
    EXPECT_EQ(error_of(1, {65535, 0}, 16), 65535);
    EXPECT_EQ(error_of(1, {1, 0}, 3), 1);
    EXPECT_EQ(error_of(32767, {std::numeric_limits<std::int64_t>::max(), std::numeric_limits<int>::max()}, 1024),
              65535);
    EXPECT_EQ(error_of(32767, {std::int64_t{1} << 30, std::numeric_limits<int>::max()}, 16), 1);
    EXPECT_EQ(error_of(-32768, {672000, std::numeric_limits<int>::min()}, 64), 65535);
}

}  // namespace
}  // namespace disparityd::test
