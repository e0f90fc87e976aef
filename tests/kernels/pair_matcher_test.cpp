// SPDX-License-Identifier: Apache-2.0
#include "kernels/pair_matcher.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/kernels/guarded.h"
#include "tests/kernels/support.h"

namespace disparityd::test {
namespace {

using testing::HasSubstr;

constexpr int width = 75;
constexpr int height = 33;

// A pair whose rows lie apart, as in a picture that is a part of another one.
struct PaddedPair {
    explicit PaddedPair(Random& random) : left_rows(width, height), right_rows(width, height) {
        const Image<std::uint8_t> left_image = noise(random, width, height);
        const Image<std::uint8_t> right_image = shifted(random, left_image, 6);
        for (int y = 0; y < height; ++y) {
            std::copy_n(left_image.plane().row(y), width, left_rows.plane().row(y));
            std::copy_n(right_image.plane().row(y), width, right_rows.plane().row(y));
        }
    }
    Plane<const std::uint8_t> left() const { return left_rows.plane(); }
    Plane<const std::uint8_t> right() const { return right_rows.plane(); }

    GuardedPlane<std::uint8_t> left_rows, right_rows;
};

Image<std::uint8_t> copy_of(Plane<const std::uint8_t> plane) {
    Image<std::uint8_t> copy(plane.width, plane.height);
    for (int y = 0; y < plane.height; ++y) {
        std::copy_n(plane.row(y), plane.width, copy.plane().row(y));
    }
    return copy;
}

class PairMatcherOf : public testing::TestWithParam<Method> {};

TEST_P(PairMatcherOf, GivesWhatTheReferenceChainGives) {
    Random random(60);
    const PaddedPair pair(random);
    MatchOptions options = default_options(GetParam(), {-2, 32});
    options.post.interpolate = true;
    const auto reference = backend("reference").create({width, height, options});
    Frame expected(*reference, copy_of(pair.left()), copy_of(pair.right()));
    ShuffledWorkers workers(3, 5);
    match_pair(*reference, expected.view, workers);

    PairMatcher matcher(width, height, options);
    EXPECT_EQ(matcher.config().width, width);
    const GuardedPlane<std::int16_t> disparity(width, height);
    const GuardedPlane<std::uint8_t> confidence(width, height);
    const GuardedPlane<std::uint16_t> depth(width, height);
    for (const bool all : {true, false}) {
        PairResults results;
        results.disparity = disparity.plane();
        results.depth_scale = expected.view.depth_scale;
        if (all) {
            results.confidence = confidence.plane();
            results.depth = depth.plane();
        }
        matcher.match(pair.left(), pair.right(), results, workers);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                ASSERT_EQ(disparity.plane().at(x, y), expected.disparity.at(x, y));
                ASSERT_EQ(confidence.plane().at(x, y), expected.confidence.at(x, y));
                ASSERT_EQ(depth.plane().at(x, y), expected.depth.at(x, y));
            }
        }
        EXPECT_TRUE(disparity.intact() && confidence.intact() && depth.intact());
    }
}

INSTANTIATE_TEST_SUITE_P(Methods, PairMatcherOf, testing::Values(Method::sad, Method::census, Method::sgm),
                         [](const auto& instance) { return std::string(to_string(instance.param)); });

TEST(PairMatcher, RefusesPlanesOfAnotherSizeByName) {
    Random random(61);
    Image<std::uint8_t> image = noise(random, 40, 20);
    Image<std::uint8_t> narrow = noise(random, 39, 20);
    Image<std::int16_t> disparity(40, 20);
    Image<std::uint16_t> low(40, 19);
    PairMatcher matcher(40, 20, default_options(Method::sad, {0, 16}));
    Serial serial;
    const auto refusal = [&](const Plane<const std::uint8_t>& left, const Plane<const std::uint8_t>& right,
                             const PairResults& results) -> std::string {
        try {
            matcher.match(left, right, results, serial);
        } catch (const std::invalid_argument& error) {
            return error.what();
        }
        return "";
    };
    PairResults results;
    results.disparity = disparity.plane();
    const Plane<const std::uint8_t> good = image.plane();
    EXPECT_EQ(refusal(good, good, results), "");
    EXPECT_THAT(refusal(narrow.plane(), good, results), HasSubstr("left plane is 39x20"));
    EXPECT_THAT(refusal(good, {}, results), HasSubstr("right plane is missing"));
    EXPECT_THAT(refusal(good, {good.data, 40, 20, 39}, results), HasSubstr("rows 39 apart"));
    EXPECT_THAT(refusal(good, good, {}), HasSubstr("disparity plane is missing"));
    results.depth = low.plane();
    EXPECT_THAT(refusal(good, good, results), HasSubstr("depth plane is 40x19"));
}

TEST(PairMatcher, RefusesWhatNoMatcherCanBeMadeFor) {
    EXPECT_THROW(PairMatcher(0, 20, {}), std::invalid_argument);
    EXPECT_THROW(PairMatcher(40, 20, {}, "none"), std::invalid_argument);
    EXPECT_THROW(PairMatcher(40, 20, default_options(Method::sgm, {0, 17})), std::invalid_argument);
}

}  // namespace
}  // namespace disparityd::test
