// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "tests/kernels/support.h"

namespace disparityd::test {
namespace {

constexpr int count = 16;

// Costs of one row of pixels; all candidates cost `usual` but those named.
template <typename T>
struct Row {
    Row(int pixels, T usual) : width(pixels), values(static_cast<std::size_t>(pixels * count), usual) {}
    T& at(int x, int k) { return values[static_cast<std::size_t>(x * count + k)]; }
    Volume<const T> volume() const { return {values.data(), width, 1, count}; }
    int width;
    std::vector<T> values;
};

template <typename T>
struct Winners {
    Winners(const Row<T>& row, int first, const PostOptions& options = {})
        : range{first, count},
          left(row.width, 1, 777),
          right(row.width, 1, 777),
          disparity(row.width, 1, 777),
          confidence(row.width, 1, 77) {
        const WinnerSteps<T>& steps = []() -> const WinnerSteps<T>& {
            if constexpr (sizeof(T) == 1) {
                return reference::steps.matching.winner_u8;
            } else {
                return reference::steps.matching.winner_u16;
            }
        }();
        steps.left(row.volume(), range, options.subpixel, left.plane(), disparity.plane(), {0, 1});
        steps.right(row.volume(), range, right.plane(), {0, 1});
        steps.local_extrema(row.volume(), range, options, left.plane(), disparity.plane(), confidence.plane(), {0, 1});
    }
    DisparityRange range;
    Image<std::int16_t> left, right, disparity;
    Image<std::uint8_t> confidence;
};

template <typename T>
class WinnerOf : public testing::Test {};
using CostTypes = testing::Types<std::uint8_t, std::uint16_t>;
TYPED_TEST_SUITE(WinnerOf, CostTypes);

TYPED_TEST(WinnerOf, SmallestOfEqualCandidatesWins) {
    Row<TypeParam> row(1, 50);
    row.at(0, 9) = 20;
    row.at(0, 5) = 20;
    EXPECT_EQ(Winners(row, 0).left.at(0, 0), 5);
    EXPECT_EQ(Winners(row, -100).left.at(0, 0), -95);
    EXPECT_EQ(Winners(row, 200).left.at(0, 0), 205);
}

TYPED_TEST(WinnerOf, SubpixelIsTheEquiangularFitInSixteenths) {
    const auto fit = [](int before, int least, int after) {
        Row<TypeParam> row(1, 60);
        row.at(0, 4) = static_cast<TypeParam>(before);
        row.at(0, 5) = static_cast<TypeParam>(least);
        row.at(0, 6) = static_cast<TypeParam>(after);
        return Winners(row, 0).disparity.at(0, 0);
    };
    EXPECT_EQ(fit(30, 10, 30), 80);
    EXPECT_EQ(fit(30, 10, 20), 80 + 4);  // 8 * 10 / 20
    EXPECT_EQ(fit(20, 10, 30), 80 - 4);
    EXPECT_EQ(fit(30, 10, 10), 80 + 8);
    EXPECT_EQ(fit(26, 10, 25), 80 + 1);  // 8 * 1 / 16 = 0.5 away from zero
    EXPECT_EQ(fit(25, 10, 26), 80 - 1);
    EXPECT_EQ(fit(27, 10, 26), 80);      // 8 / 17 < 0.5
    EXPECT_EQ(fit(11, 10, 42), 80 - 8);  // -7.75
}

TYPED_TEST(WinnerOf, SubpixelEqualsRoundingOfTheQuotient) {
    Random random(11);
    for (int round = 0; round < 2000; ++round) {
        Row<TypeParam> row(1, 120);
        const int least = pick(random, 0, 100);
        const int before = pick(random, least + 1, 119);
        const int after = pick(random, least, 119);
        row.at(0, 7) = static_cast<TypeParam>(before);
        row.at(0, 8) = static_cast<TypeParam>(least);
        row.at(0, 9) = static_cast<TypeParam>(after);
        const double quotient = 8.0 * (before - after) / (std::max(before, after) - least);
        ASSERT_EQ(Winners(row, 3).disparity.at(0, 0), 16 * 11 + std::lround(quotient))
            << before << " " << least << " " << after;
        ASSERT_EQ(Winners(row, 3, {.subpixel = false}).disparity.at(0, 0), 16 * 11);
    }
}

TYPED_TEST(WinnerOf, EndsOfTheRangeStayWhole) {
    Row<TypeParam> row(2, 60);
    row.at(0, 0) = 10;
    row.at(0, 1) = 11;
    row.at(1, count - 1) = 10;
    row.at(1, count - 2) = 11;
    const Winners found(row, -3);
    EXPECT_EQ(found.disparity.at(0, 0), -48);
    EXPECT_EQ(found.disparity.at(1, 0), 16 * 12);
}

TYPED_TEST(WinnerOf, RightImageIsReadAlongTheDiagonal) {
    // Left pixel 9 matches right pixel 4 at d = 5; right pixel 4's other candidates are left pixels 4 to 19.
    Row<TypeParam> row(20, 60);
    row.at(9, 5) = 10;
    row.at(12, 8) = 10;  // also right pixel 4, larger d: the smaller one wins
    row.at(13, 8) = 7;   // right pixel 5
    const Winners found(row, 0);
    EXPECT_EQ(found.right.at(4, 0), 5);
    EXPECT_EQ(found.right.at(5, 0), 8);
    EXPECT_EQ(found.right.at(19, 0), 0);
}

TYPED_TEST(WinnerOf, RightImageHasNoWinnerWithoutACandidateInsideTheLeft) {
    Row<TypeParam> row(20, 60);
    const Winners found(row, 15);
    EXPECT_EQ(found.right.at(4, 0), 15);  // left pixel 19
    EXPECT_EQ(found.right.at(5, 0), 14);  // none: first - 1
    const Winners negative(row, -20);
    EXPECT_EQ(negative.right.at(4, 0), -21);
    EXPECT_EQ(negative.right.at(5, 0), -5);  // only d = -5 meets left pixel 0
}

TYPED_TEST(WinnerOf, RightImageEqualsASearchPerPixel) {
    Random random(12);
    for (int round = 0; round < 200; ++round) {
        const int width = pick(random, 1, 40);
        const int first = pick(random, -30, 30);
        Row<TypeParam> row(width, 0);
        for (TypeParam& value : row.values) {
            value = static_cast<TypeParam>(pick(random, 0, 9));
        }
        const Winners found(row, first);
        for (int x = 0; x < width; ++x) {
            int best = first - 1;
            int least = 1000;
            for (int d = first; d < first + count; ++d) {
                if (x + d >= 0 && x + d < width && row.at(x + d, d - first) < least) {
                    least = row.at(x + d, d - first);
                    best = d;
                }
            }
            ASSERT_EQ(found.right.at(x, 0), best);
        }
    }
}

TYPED_TEST(WinnerOf, LocalExtremaRejectsEndsWithAnEqualNeighbour) {
    Row<TypeParam> row(4, 60);
    row.at(0, 0) = row.at(0, 1) = 10;
    row.at(1, 0) = 10;
    row.at(2, 6) = row.at(2, 7) = 10;  // equal neighbour, but not at an end
    // pixel 3: all equal
    const Winners found(row, 0);
    EXPECT_EQ(found.disparity.at(0, 0), -16);
    EXPECT_EQ(found.confidence.at(0, 0), 0);
    EXPECT_EQ(found.disparity.at(1, 0), 0);
    EXPECT_EQ(found.disparity.at(2, 0), 16 * 6 + 8);
    EXPECT_EQ(found.disparity.at(3, 0), -16);
    const Winners kept(row, 0, {.local_extrema = false});
    EXPECT_EQ(kept.disparity.at(0, 0), 0);
    EXPECT_EQ(kept.disparity.at(3, 0), 0);
    EXPECT_EQ(kept.confidence.at(3, 0), 1);
}

TYPED_TEST(WinnerOf, UniquenessComparesWithCandidatesThatAreNoNeighbours) {
    Row<TypeParam> row(1, 200);
    row.at(0, 5) = 90;
    row.at(0, 6) = 91;  // a neighbour does not count
    row.at(0, 12) = 100;
    const auto rejected = [&](int percent) {
        return Winners(row, 0, {.uniqueness = percent}).disparity.at(0, 0) == -16;
    };
    EXPECT_FALSE(rejected(0));
    EXPECT_FALSE(rejected(9));  // 100 * 91 > 90 * 100
    EXPECT_TRUE(rejected(10));  // 100 * 90 <= 90 * 100
    EXPECT_TRUE(rejected(50));
    row.at(0, 12) = 90;
    EXPECT_TRUE(rejected(1));
    EXPECT_FALSE(rejected(0));
}

TYPED_TEST(WinnerOf, ConfidenceGrowsWithTheDistanceToTheSecondBest) {
    Row<TypeParam> row(4, 200);
    row.at(0, 5) = 50;                                // second 200
    row.at(1, 5) = 0;                                 // second 200
    row.at(2, 5) = 199;                               // second 200
    std::fill_n(&row.at(3, 0), count, TypeParam{0});  // second 0
    const Winners found(row, 0, {.local_extrema = false});
    EXPECT_EQ(found.confidence.at(0, 0), 1 + 254 * 150 / 200);
    EXPECT_EQ(found.confidence.at(1, 0), 255);
    EXPECT_EQ(found.confidence.at(2, 0), 2);
    EXPECT_EQ(found.confidence.at(3, 0), 1);
}

}  // namespace
}  // namespace disparityd::test
