// SPDX-License-Identifier: Apache-2.0
#include "calibration/depth_range.h"

#include <cmath>

#include <gmock/gmock.h>

namespace disparityd::calibration {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// A camera of 350 px and 120 mm: f B = 42 px m.
DepthRange depths(DisparityRange range, double offset = 0, bool subpixel = true) {
    MatchOptions options = default_options(Method::sgm, range);
    options.post.subpixel = subpixel;
    return DepthRange::of(350, 120, offset, options).value();
}

TEST(DepthRange, TheLimitsAreThoseOfTheFirstAndTheLastCandidate) {
    EXPECT_NEAR(depths({0, 64}).nearest_m(), 42.0 / 63, 1e-12);
    EXPECT_TRUE(std::isinf(depths({0, 64}).farthest_m()));
    EXPECT_NEAR(depths({8, 64}).nearest_m(), 42.0 / 71, 1e-12);
    EXPECT_NEAR(depths({8, 64}).farthest_m(), 42.0 / 8, 1e-12);
    EXPECT_NEAR(depths({0, 64}, 30).nearest_m(), 42.0 / 93, 1e-12);
    EXPECT_NEAR(depths({0, 64}, 30).farthest_m(), 42.0 / 30, 1e-12);
    EXPECT_TRUE(std::isinf(depths({-64, 64}).nearest_m()));
}

TEST(DepthRange, WithoutFocalLengthOrBaselineThereIsNone) {
    EXPECT_FALSE(DepthRange::of(0, 120, 0, {}));
    EXPECT_FALSE(DepthRange::of(350, 0, 0, {}));
}

TEST(DepthRange, TheResolutionIsWhatOneStepLessReads) {
    EXPECT_NEAR(depths({0, 64}).error_m(5, 1), 42 / 7.4 - 5, 1e-12);
    EXPECT_NEAR(depths({0, 64}).error_m(10, 1.0 / 16), 42 / (4.2 - 0.0625) - 10, 1e-12);
    EXPECT_TRUE(std::isinf(depths({0, 64}).error_m(50, 1))) << "0.84 px less 1 px is nowhere";
}

TEST(DepthRange, TheDisparitiesForALimitAreTheFewestThatReachIt) {
    for (const double wanted : {2.0, 1.0, 0.5, 0.3, 0.2}) {
        const int count = depths({0, 64}).disparities_for(wanted).value();
        EXPECT_EQ(count % 16, 0);
        EXPECT_LE(depths({0, count}).nearest_m(), wanted);
        EXPECT_TRUE(count == 16 || depths({0, count - 16}).nearest_m() > wanted) << wanted;
    }
    EXPECT_EQ(depths({-16, 64}).disparities_for(0.5), 112);
    EXPECT_EQ(depths({0, 64}, 30).disparities_for(0.5), 64);
    EXPECT_FALSE(depths({0, 64}).disparities_for(0.1));
}

TEST(DepthRange, TheLineHasLimitsNeedsAndResolution) {
    EXPECT_EQ(
        depths({0, 64}).text(),
        "nothing nearer than 0.67 m is measured (disparities up to 63 px, f 350 px, baseline 120 mm); 0.5 m needs "
        "96 disparities, 0.3 m needs 144 disparities; at 5 m a step of 1/16 px is 0.037 m, an error of 1 px "
        "0.68 m; at 10 m a step of 1/16 px is 0.15 m, an error of 1 px 3.12 m");
    EXPECT_THAT(depths({8, 64}).text(), HasSubstr("nothing nearer than 0.60 m, nor farther than 5.25 m, is measured"));
    EXPECT_THAT(depths({0, 16}, 0, false).text(), AllOf(HasSubstr("a step of 1 px is 0.68 m"), Not(HasSubstr("1/16"))));
    EXPECT_THAT(depths({-64, 64}).text(), HasSubstr("no distance is measured"));
    const auto large = DepthRange::of(1400, 120, 0, default_options(Method::sgm, {0, 64})).value();
    EXPECT_THAT(large.text(),
                HasSubstr("1 m needs 176 disparities, 0.5 m needs more than the 256 that there are: take"));
}

}  // namespace
}  // namespace disparityd::calibration
