// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/kernels/support.h"

namespace disparityd::test {

using Bytes = Image<std::uint8_t>;

// All equal, two values, extremes, noise, a shifted copy.
struct Pair {
    Pair(Random& random, int width, int height) : left(width, height), right(width, height) {
        const int kind = pick(random, 0, 4);
        left = kind == 0 ? Bytes(width, height, 99) : noise(random, width, height, 0, kind == 1 ? 1 : 255);
        right = kind == 0   ? left
                : kind == 2 ? shifted(random, left, pick(random, -20, 20))
                            : noise(random, width, height);
        for (Bytes* image : {&left, &right}) {
            for (std::uint8_t& pixel : image->pixels()) {
                pixel = kind != 3 ? pixel : pixel < 128 ? 0 : 255;
            }
        }
    }
    Pair(Bytes left_image, Bytes right_image) : left(std::move(left_image)), right(std::move(right_image)) {}
    Bytes left, right;
};

inline MatchOptions any_options(Random& random) {
    MatchOptions options;
    options.method = static_cast<Method>(pick(random, 0, 2));
    options.range = {pick(random, -40, 40), 16 * pick(random, 1, 5)};
    options.sgm.paths = pick(random, 0, 2) == 0 ? 4 : 8;
    options.sgm.p2 = pick(random, 2, 193);
    options.sgm.p1 = pick(random, 1, options.sgm.p2 - 1);
    options.sgm.adaptive_p2 = pick(random, 0, 1) == 1;
    options.post.subpixel = pick(random, 0, 3) > 0;
    options.post.local_extrema = pick(random, 0, 1) == 1;
    options.post.uniqueness = pick(random, 0, 1) * pick(random, 0, 99);
    options.post.left_right_check = pick(random, 0, 3) > 0;
    options.post.median = std::array{0, 3, 5}[static_cast<std::size_t>(pick(random, 0, 2))];
    options.post.speckle_size = pick(random, 0, 1) * pick(random, 0, 40);
    options.post.speckle_step = pick(random, 0, 2);
    options.post.interpolate = pick(random, 0, 1) == 1;
    return options;
}

struct Result {
    std::vector<std::int16_t> disparity;
    std::vector<std::uint8_t> confidence;
    std::vector<std::uint16_t> depth;
    bool operator==(const Result&) const = default;
};

inline Result result_of(std::string_view name, const Pair& pair, const MatchOptions& options) {
    Serial serial;
    const auto matcher = backend(name).create({pair.left.width(), pair.left.height(), options});
    Frame frame(*matcher, pair.left, pair.right);
    match(*matcher, frame.view, serial);
    return {frame.disparity.pixels(), frame.confidence.pixels(), frame.depth.pixels()};
}

inline void expect_equal_to_reference(const Pair& pair, const MatchOptions& options) {
    ASSERT_EQ(problem(options), "");
    const Result expected = result_of("reference", pair, options);
    const Result found = result_of("cuda", pair, options);
    const auto where = [&] {
        return std::to_string(pair.left.width()) + "x" + std::to_string(pair.left.height()) + " " +
               std::string(name(options.method)) + ", D " + std::to_string(options.range.count) + " from " +
               std::to_string(options.range.first) + ", " + std::to_string(options.sgm.paths) + " paths";
    };
    ASSERT_EQ(found.disparity, expected.disparity) << where();
    ASSERT_EQ(found.confidence, expected.confidence) << where();
    ASSERT_EQ(found.depth, expected.depth) << where();
}

}  // namespace disparityd::test
