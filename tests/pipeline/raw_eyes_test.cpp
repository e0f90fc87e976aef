// SPDX-License-Identifier: Apache-2.0
#include "pipeline/raw_eyes.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include <gtest/gtest.h>

namespace disparityd::pipeline {
namespace {

/// Both eyes of 2 x 2 pixels, in rows that are `stride` bytes apart.
struct Copied {
    std::array<std::uint8_t, 4> left{};
    std::array<std::uint8_t, 4> right{};
};

Copied copied(PixelFormat format, std::initializer_list<std::uint8_t> first,
              std::initializer_list<std::uint8_t> second) {
    constexpr std::ptrdiff_t stride = 16;
    std::vector<std::uint8_t> bytes(2 * stride, 99);
    std::copy(first.begin(), first.end(), bytes.begin());
    std::copy(second.begin(), second.end(), bytes.begin() + stride);
    Copied made;
    copy_luma({bytes.data(), format, 2, 2, stride}, {{made.left.data(), 2, 2, 2}, {made.right.data(), 2, 2, 2}});
    return made;
}

using Pixels = std::array<std::uint8_t, 4>;

TEST(RawEyes, GreyIsCopied) {
    const Copied made = copied(PixelFormat::grey8, {1, 2, 3, 4}, {5, 6, 7, 8});
    EXPECT_EQ(made.left, (Pixels{1, 2, 5, 6}));
    EXPECT_EQ(made.right, (Pixels{3, 4, 7, 8}));
}

TEST(RawEyes, OfYuyvTheLuma) {
    const Copied made = copied(PixelFormat::yuyv, {10, 128, 20, 128, 30, 1, 40, 2}, {50, 3, 60, 4, 70, 5, 80, 6});
    EXPECT_EQ(made.left, (Pixels{10, 20, 50, 60}));
    EXPECT_EQ(made.right, (Pixels{30, 40, 70, 80}));
}

// By the weights of step 1: 255 x 3735 / 32768 = 29.06, 255 x 19235 / 32768 = 149.69, 255 x 9798 / 32768 = 76.25.
TEST(RawEyes, OfColoursTheLumaOfStepOne) {
    const Copied made = copied(PixelFormat::bgr24, {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255},
                               {0, 0, 0, 1, 1, 1, 128, 128, 128, 254, 255, 255});
    EXPECT_EQ(made.left, (Pixels{29, 150, 0, 1}));
    EXPECT_EQ(made.right, (Pixels{76, 255, 128, 255}));
}

}  // namespace
}  // namespace disparityd::pipeline
