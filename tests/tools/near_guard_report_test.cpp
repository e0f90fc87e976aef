// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/near_guard_report.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/kernels/support.h"

namespace disparityd::eval {
namespace {

constexpr DisparityRange range{0, 16};

/// Two sectors of 24 x 8 pixels: the left one shows a thing at 20 px in all but its first column, the right one a wall
/// at 10.
struct Picture {
    Picture() : without(48, 8, 0), with(48, 8, 0), near(12, 2, not_near) {
        for (int y = 0; y < truth.height; ++y) {
            for (int x = 0; x < truth.width; ++x) {
                truth.values.push_back(x == 0 ? std::numeric_limits<float>::infinity() : x < 24 ? 20.0F : 10.0F);
            }
        }
    }

    NearGuardCounts counted() const { return count_near(truth, range, without.plane(), with.plane(), near.plane()); }

    images::FloatMap truth{48, 8, {}};
    test::Image<std::uint8_t> without, with;
    test::Image<std::int16_t> near;
};

TEST(NearGuardReport, CountsWhatIsNearerAndWhatOfItIsFound) {
    Picture picture;
    picture.without.at(5, 0) = 200;
    picture.without.at(6, 0) = 1;
    picture.with.at(6, 0) = 1;
    picture.near.at(1, 0) = 16 * 21;  // within 10 %
    picture.near.at(2, 0) = 16 * 23;
    const NearGuardCounts counts = picture.counted();
    EXPECT_EQ(counts.pixels, 384U);
    EXPECT_EQ(counts.nearer, 184U);
    EXPECT_EQ(counts.farther, 192U);
    EXPECT_EQ(counts.nearer_measured_without, 2U);
    EXPECT_EQ(counts.nearer_measured, 1U);
    EXPECT_EQ(counts.nearer_flagged, 32U);
    EXPECT_EQ(counts.nearer_flagged_right, 16U);
    EXPECT_EQ(counts.farther_flagged, 0U);
    EXPECT_EQ(counts.flagged, 32U);
    EXPECT_EQ(counts.sectors, 2U);
    EXPECT_EQ(counts.sectors_nearer, 1U);
    EXPECT_EQ(counts.sectors_found, 1U);
    EXPECT_EQ(counts.sectors_flagged, 1U);
}

TEST(NearGuardReport, CountsFalseAlarms) {
    Picture picture;
    picture.near.at(11, 1) = 16 * 20;
    const NearGuardCounts counts = picture.counted();
    EXPECT_EQ(counts.farther_flagged, 16U);
    EXPECT_EQ(counts.nearer_flagged, 0U);
    EXPECT_EQ(counts.sectors_found, 0U);
    EXPECT_EQ(counts.sectors_flagged, 1U);
}

TEST(NearGuardReport, TheLastCandidateIsInTheRange) {
    Picture picture;
    for (float& truth : picture.truth.values) {
        truth = truth == 20 ? 15.0F : truth == 10 ? 15.5F : truth;
    }
    const NearGuardCounts counts = picture.counted();
    EXPECT_EQ(counts.nearer, 0U);
    EXPECT_EQ(counts.farther, 184U);
}

}  // namespace
}  // namespace disparityd::eval
