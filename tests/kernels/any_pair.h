// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "tests/kernels/support.h"

namespace disparityd::test {

using Bytes = Image<std::uint8_t>;

/// Images that have broken vector code before: all equal, two values, extremes, noise, a shifted copy.
struct Pair {
    Pair(Random& random, int width, int height) : left(width, height), right(width, height) {
        const int kind = pick(random, 0, 4);
        left = kind == 0 ? Bytes(width, height, static_cast<std::uint8_t>(pick(random, 0, 255)))
                         : noise(random, width, height, 0, kind == 1 ? 1 : 255);
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

    int width() const { return left.width(); }
    int height() const { return left.height(); }

    Bytes left, right;
};

/// Census words that differ in all 62 bits: rising on the left in the order of the window, falling on the right. For
/// sizes with width + 9 height <= 256.
inline Pair pair_of_opposites(int width, int height) {
    Pair pair{Bytes(width, height), Bytes(width, height)};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            pair.left.at(x, y) = static_cast<std::uint8_t>(x + 9 * y);
            pair.right.at(x, y) = static_cast<std::uint8_t>(255 - (x + 9 * y));
        }
    }
    return pair;
}

/// Any options of any method.
inline MatchOptions any_options(Random& random) {
    MatchOptions options;
    options.method = static_cast<Method>(pick(random, 0, 2));
    options.cost = static_cast<CensusCost>(pick(random, 0, 1));
    options.range = {pick(random, -40, 40), 16 * pick(random, 1, 5)};
    options.sgm.paths = pick(random, 0, 2) == 0 ? 4 : 8;
    options.sgm.p2 = pick(random, 2, 193);
    options.sgm.p1 = pick(random, 1, options.sgm.p2 - 1);
    options.sgm.adaptive_p2 = pick(random, 0, 1) == 1;
    options.sgm.p2_slope = pick(random, 1, 8);
    options.sgm.p2_min = pick(random, 0, 2) == 0 ? pick(random, 0, options.sgm.p2) : 0;
    options.sgm.calibrated_confidence = pick(random, 0, 1) == 1;
    options.post.subpixel = pick(random, 0, 3) > 0;
    options.post.local_extrema = pick(random, 0, 1) == 1;
    options.post.uniqueness = pick(random, 0, 1) * pick(random, 0, 99);
    options.post.left_right_check = pick(random, 0, 3) > 0;
    options.post.median = std::array{0, 3, 5}[static_cast<std::size_t>(pick(random, 0, 2))];
    options.post.speckle_size = pick(random, 0, 1) * pick(random, 0, 40);
    options.post.speckle_step = pick(random, 0, 2);
    options.post.min_texture = pick(random, 0, 1) * pick(random, 0, 30);
    options.post.interpolate = pick(random, 0, 1) == 1;
    options.post.guided_median = std::array{0, 5, 7}[static_cast<std::size_t>(pick(random, 0, 2))];
    options.post.near_guard = pick(random, 0, 1) == 1;
    options.post.saturated_level = pick(random, 0, 1) * pick(random, 1, 255);
    return options;
}

/// Any options of a method that has noise levels.
inline MatchOptions options_with_noise_levels(Random& random) {
    MatchOptions options = any_options(random);
    options.method = Method::sgm;
    options.cost = CensusCost::census_7x5_gradient;
    options.sgm.paths = 4;
    options.sgm.adaptive_p2 = true;
    return options;
}

/// What a matcher says of a pair.
struct Result {
    explicit Result(const Frame& frame)
        : disparity(frame.disparity.pixels()),
          confidence(frame.confidence.pixels()),
          depth(frame.depth.pixels()),
          depth_error(frame.depth_error.pixels()),
          near(frame.near.pixels()) {}

    std::vector<std::int16_t> disparity;
    std::vector<std::uint8_t> confidence;
    std::vector<std::uint16_t> depth;
    std::vector<std::uint16_t> depth_error;
    std::vector<std::int16_t> near;
    bool operator==(const Result&) const = default;
};

inline Result result_of(Matcher& matcher, const Pair& pair, Parallel& workers, int noise_level = 0) {
    Frame frame(matcher, pair.left, pair.right);
    frame.view.noise_level = noise_level;
    match_pair(matcher, frame.view, workers);
    return Result(frame);
}

/// The same of a back end by name.
inline Result result_of(std::string_view name, const Pair& pair, const MatchOptions& options) {
    Serial serial;
    return result_of(*backend(name).create({pair.width(), pair.height(), options}), pair, serial);
}

inline void expect_result(const Result& found, const Result& expected, const MatcherConfig& config,
                          const Parallel& workers) {
    const MatchOptions& options = config.options;
    const auto where = [&] {
        return testing::Message() << config.width << "x" << config.height << " " << to_string(options.method) << " "
                                  << to_string(options.cost) << ", D " << options.range.count << " from "
                                  << options.range.first << ", " << options.sgm.paths << " paths, " << workers.workers()
                                  << " workers";
    };
    ASSERT_EQ(found.disparity, expected.disparity) << where();
    ASSERT_EQ(found.confidence, expected.confidence) << where();
    ASSERT_EQ(found.depth, expected.depth) << where();
    ASSERT_EQ(found.depth_error, expected.depth_error) << where();
    ASSERT_EQ(found.near, expected.near) << where();
}

inline void expect_equal_to_reference(Matcher& matcher, const Pair& pair, Parallel& workers) {
    const MatchOptions& options = matcher.config().options;
    ASSERT_EQ(validate(options), "");
    expect_result(result_of(matcher, pair, workers), result_of("reference", pair, options), matcher.config(), workers);
}

}  // namespace disparityd::test
