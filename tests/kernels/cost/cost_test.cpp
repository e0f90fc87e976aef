// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <bitset>
#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/kernels/support.h"

namespace disparityd::test {
namespace {

std::vector<std::uint64_t> census(const Image<std::uint8_t>& image) {
    Image<std::uint64_t> words(image.width(), image.height(), 99);
    reference::census(image.plane(), words.plane(), words.rows());
    return words.pixels();
}

TEST(Census, BitsAreInRasterOrderWithTheFirstOneHighest) {
    Image<std::uint8_t> image(9, 7, 100);
    const auto centre = [&] { return census(image)[3 * 9 + 4]; };
    EXPECT_EQ(centre(), 0U);
    image.at(0, 0) = 99;
    EXPECT_EQ(centre(), std::uint64_t{1} << 61);
    image.at(0, 0) = 101;
    image.at(8, 6) = 0;
    EXPECT_EQ(centre(), 1U);
    image.at(8, 6) = 100;
    image.at(3, 3) = 99;  // left of the centre: 31 bits come after it
    EXPECT_EQ(centre(), std::uint64_t{1} << 31);
    image.at(5, 3) = 99;
    EXPECT_EQ(centre(), (std::uint64_t{1} << 31) + (std::uint64_t{1} << 30));
}

TEST(Census, BorderIsReplicated) {
    // A single dark column on the left: each pixel sees it, and what replicates it, to its left.
    Image<std::uint8_t> image(6, 1, 50);
    image.at(0, 0) = 10;
    const std::vector<std::uint64_t> words = census(image);
    EXPECT_EQ(words[0], 0U);
    EXPECT_EQ(std::popcount(words[1]), 4 * 7);  // four of nine columns are dark
    EXPECT_EQ(std::popcount(words[4]), 7);
    EXPECT_EQ(words[5], 0U);
    EXPECT_EQ(census(Image<std::uint8_t>(1, 1, 7))[0], 0U);
}

TEST(Census, EqualsTheDefinitionOnNoise) {
    Random random(4);
    for (const auto& [width, height] : {std::pair{23, 17}, {1, 9}, {12, 1}, {3, 2}}) {
        const Image<std::uint8_t> image = noise(random, width, height, 0, 7);
        const std::vector<std::uint64_t> words = census(image);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                std::string bits;
                for (int dy = -3; dy <= 3; ++dy) {
                    for (int dx = -4; dx <= 4; ++dx) {
                        const int neighbour =
                            image.at(std::clamp(x + dx, 0, width - 1), std::clamp(y + dy, 0, height - 1));
                        if (dx != 0 || dy != 0) {
                            bits += neighbour < image.at(x, y) ? '1' : '0';
                        }
                    }
                }
                ASSERT_EQ(words[static_cast<std::size_t>(y * width + x)], std::bitset<62>(bits).to_ullong());
            }
        }
    }
}

TEST(MatchingCost, CountsDifferingBitsAndKnowsTheRightImagesEnds) {
    Random random(5);
    for (const DisparityRange range : {DisparityRange{0, 16}, {-5, 16}, {-40, 32}, {30, 16}, {-256, 16}, {256, 256}}) {
        const int width = 21;
        Image<std::uint64_t> left(width, 3);
        Image<std::uint64_t> right(width, 3);
        for (std::size_t i = 0; i < left.pixels().size(); ++i) {
            left.pixels()[i] = (std::uint64_t{random()} << 30) ^ random();
            right.pixels()[i] = (std::uint64_t{random()} << 30) ^ random();
        }
        std::vector<std::uint8_t> costs(static_cast<std::size_t>(width * 3 * range.count), 99);
        const Volume<std::uint8_t> volume{costs.data(), width, 3, range.count};
        reference::matching_cost(left.plane(), right.plane(), range, volume, left.rows());
        for (int y = 0; y < 3; ++y) {
            for (int x = 0; x < width; ++x) {
                for (int k = 0; k < range.count; ++k) {
                    const int match = x - range.first - k;
                    const int expected =
                        match < 0 || match >= width ? 62 : std::popcount(left.at(x, y) ^ right.at(match, y));
                    ASSERT_EQ(volume.pixel(x, y)[k], expected) << x << " " << k;
                }
            }
        }
    }
}

// The words of one image of census-7x5+gradient.
std::vector<std::uint64_t> census_gradient(const Image<std::uint8_t>& image) {
    Image<std::uint64_t> words(image.width(), image.height(), 99);
    reference::census_gradient(image.plane(), words.plane(), words.rows());
    return words.pixels();
}

TEST(CensusGradient, BitsAreThoseOfTheWindowWithoutCorners) {
    Image<std::uint8_t> image(7, 5, 100);
    const auto census_part = [&] { return census_gradient(image)[2 * 7 + 3] & 0xffffffff; };
    EXPECT_EQ(census_part(), 0U);
    for (const auto& [x, y] : {std::pair{0, 0}, {6, 0}, {0, 4}, {6, 4}}) {
        image.at(x, y) = 0;
    }
    EXPECT_EQ(census_part(), 0U);
    image.at(1, 0) = 99;
    EXPECT_EQ(census_part(), std::uint64_t{1} << 29);
    image.at(1, 0) = 101;
    image.at(5, 4) = 0;
    EXPECT_EQ(census_part(), 1U);
    image.at(5, 4) = 100;
    image.at(2, 2) = 99;  // left of the centre: 5 + 7 + 2 bits before it, 15 after it
    EXPECT_EQ(census_part(), std::uint64_t{1} << 15);
}

TEST(CensusGradient, GradientIsHalfOfSobelsAndClamped) {
    Image<std::uint8_t> image(3, 3, 100);
    const auto gradient = [&] { return static_cast<int>(census_gradient(image)[4] >> 32); };
    EXPECT_EQ(gradient(), 128);
    image.at(2, 0) = 103;  // s = 3: rounded down
    EXPECT_EQ(gradient(), 129);
    image.at(2, 0) = 100;
    image.at(0, 0) = 103;  // s = -3
    EXPECT_EQ(gradient(), 126);
    image.at(0, 1) = 107;  // s = -3 - 14
    EXPECT_EQ(gradient(), 128 - 9);
    image.at(0, 1) = 255;
    EXPECT_EQ(gradient(), 128 - 16);
    image.at(2, 1) = 255;
    image.at(2, 2) = 255;
    EXPECT_EQ(gradient(), 128 + 16);
}

TEST(CensusGradient, EqualsOpenCvsSobelOnNoise) {
    Random random(19);
    for (const auto& [width, height] : {std::pair{31, 17}, {1, 9}, {12, 1}, {2, 2}}) {
        Image<std::uint8_t> image = noise(random, width, height, 100, pick(random, 100, 140));
        cv::Mat sobel;
        cv::Sobel(cv::Mat(height, width, CV_8U, image.plane().data), sobel, CV_16S, 1, 0, 3, 1, 0,
                  cv::BORDER_REPLICATE);
        const std::vector<std::uint64_t> words = census_gradient(image);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const double s = std::clamp<int>(sobel.at<std::int16_t>(y, x), -32, 32);
                ASSERT_EQ(static_cast<int>(words[static_cast<std::size_t>(y * width + x)] >> 32),
                          128 + static_cast<int>(std::floor(s / 2)));
            }
        }
    }
}

TEST(CensusGradientCost, IsTheSumOfBothPartsAveragedOverRows) {
    // One candidate inside, d = 0 of the only column; three rows of costs 3, 8 and 12.
    const auto word = [](std::uint64_t census, std::uint64_t gradient) { return gradient << 32 | census; };
    Image<std::uint64_t> left(1, 3, {word(0x7, 128), word(0xf, 128), word(0, 144)});
    Image<std::uint64_t> right(1, 3, {word(0, 128), word(0, 132), word(0, 112)});
    std::vector<std::uint8_t> costs(3 * 16, 99);
    const Volume<std::uint8_t> volume{costs.data(), 1, 3, 16};
    reference::census_gradient_cost(left.plane(), right.plane(), {0, 16}, volume, left.rows());
    // avg(avg(3, 8), 3) = avg(6, 3), avg(avg(3, 12), 8) = avg(8, 8), avg(avg(8, 12), 12) = avg(10, 12)
    EXPECT_EQ(volume.pixel(0, 0)[0], 5);
    EXPECT_EQ(volume.pixel(0, 1)[0], 8);
    EXPECT_EQ(volume.pixel(0, 2)[0], 11);
    EXPECT_EQ(volume.pixel(0, 1)[1], 18);
}

TEST(CensusGradientCost, KnowsTheRightImagesEnds) {
    Random random(20);
    for (const DisparityRange range : {DisparityRange{0, 16}, {-5, 16}, {-40, 32}, {30, 16}, {-256, 16}, {256, 256}}) {
        const int width = 21;
        const Image<std::uint8_t> left_image = noise(random, width, 4), right_image = noise(random, width, 4);
        Image<std::uint64_t> left(width, 4), right(width, 4);
        reference::census_gradient(left_image.plane(), left.plane(), left.rows());
        reference::census_gradient(right_image.plane(), right.plane(), right.rows());
        std::vector<std::uint8_t> costs(static_cast<std::size_t>(width * 4 * range.count), 99);
        const Volume<std::uint8_t> volume{costs.data(), width, 4, range.count};
        reference::census_gradient_cost(left.plane(), right.plane(), range, volume, left.rows());
        for (int y = 0; y < 4; ++y) {
            for (int x = 0; x < width; ++x) {
                for (int k = 0; k < range.count; ++k) {
                    const int match = x - range.first - k;
                    const bool inside = match >= 0 && match < width;
                    ASSERT_LE(volume.pixel(x, y)[k], 42);
                    ASSERT_TRUE(inside || volume.pixel(x, y)[k] == 18) << x << " " << k;
                }
            }
        }
    }
}

TEST(Sad, EqualsOpenCvsBoxFilterOfDifferences) {
    Random random(6);
    for (const auto& [width, height] : {std::pair{41, 13}, {5, 4}, {1, 1}, {30, 1}, {2, 20}}) {
        for (const DisparityRange range : {DisparityRange{0, 16}, {-9, 32}, {-256, 16}, {20, 48}, {256, 256}}) {
            Image<std::uint8_t> left = noise(random, width, height);
            Image<std::uint8_t> right = noise(random, width, height);
            std::vector<std::uint16_t> costs(static_cast<std::size_t>(width * height * range.count), 99);
            const Volume<std::uint16_t> volume{costs.data(), width, height, range.count};
            reference::sad(left.plane(), right.plane(), range, volume, left.rows());

            const cv::Mat left_image(height, width, CV_8U, left.plane().data);
            const cv::Mat right_image(height, width, CV_8U, right.plane().data);
            cv::Mat wide_right;
            cv::copyMakeBorder(right_image, wide_right, 0, 0, 600, 600, cv::BORDER_REPLICATE);
            for (int k = 0; k < range.count; ++k) {
                const int d = range.first + k;
                cv::Mat difference;
                cv::Mat sums;
                cv::absdiff(left_image, wide_right(cv::Rect(600 - d, 0, width, height)), difference);
                cv::boxFilter(difference, sums, CV_16U, {9, 7}, {-1, -1}, false, cv::BORDER_REPLICATE);
                for (int y = 0; y < height; ++y) {
                    for (int x = 0; x < width; ++x) {
                        const bool inside = x - d >= 0 && x - d < width;
                        ASSERT_EQ(volume.pixel(x, y)[k], inside ? sums.at<std::uint16_t>(y, x) : 16065)
                            << x << "," << y << " d " << d << " of " << width << "x" << height;
                    }
                }
            }
        }
    }
}

TEST(Sad, BlackAgainstWhiteIsTheLargestSumAndEqualsAMissingCandidate) {
    Image<std::uint8_t> black(4, 2, 0);
    Image<std::uint8_t> white(4, 2, 255);
    std::vector<std::uint16_t> costs(4 * 2 * 16);
    reference::sad(black.plane(), white.plane(), {0, 16}, {costs.data(), 4, 2, 16}, black.rows());
    EXPECT_EQ(costs, std::vector<std::uint16_t>(4 * 2 * 16, 9 * 7 * 255));
}

}  // namespace
}  // namespace disparityd::test
