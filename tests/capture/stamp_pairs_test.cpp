// SPDX-License-Identifier: Apache-2.0
#include "capture/stamp_pairs.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace disparityd::capture {
namespace {

struct Stamp {
    std::int64_t stamp_ns = 0;
    std::size_t bytes() const { return 1; }
};

/// Returns the pairs of these stamps, which come eye by eye in turn.
std::vector<std::pair<std::int64_t, std::int64_t>> pairs_of(std::int64_t within, const std::vector<std::int64_t>& left,
                                                            const std::vector<std::int64_t>& right) {
    StampPairs<Stamp> pairs(within);
    std::vector<std::pair<std::int64_t, std::int64_t>> found;
    const auto take = [&](bool ended) {
        while (const auto pair = pairs.take(ended)) {
            found.emplace_back(pair->left.stamp_ns, pair->right.stamp_ns);
        }
    };
    for (std::size_t i = 0; i < std::max(left.size(), right.size()); ++i) {
        if (i < left.size()) {
            pairs.add(Eye::left, {left[i]});
        }
        take(false);
        if (i < right.size()) {
            pairs.add(Eye::right, {right[i]});
        }
        take(false);
    }
    take(true);
    return found;
}

using Pairs = std::vector<std::pair<std::int64_t, std::int64_t>>;

TEST(StampPairs, EqualStampsAreAPairAtOnce) {
    StampPairs<Stamp> pairs(5);
    pairs.add(Eye::right, {7});
    EXPECT_FALSE(pairs.take(false));
    pairs.add(Eye::left, {7});
    EXPECT_TRUE(pairs.take(false));
    EXPECT_EQ(pairs.take_unpaired(), 0U);
}

TEST(StampPairs, TheNearestWithinTheLimitAre) {
    EXPECT_EQ(pairs_of(5, {0, 10, 20}, {2, 12, 22}), (Pairs{{0, 2}, {10, 12}, {20, 22}}));
    EXPECT_EQ(pairs_of(5, {0, 4, 20}, {5, 21}), (Pairs{{4, 5}, {20, 21}})) << "4 is nearer to 5 than 0 is";
    EXPECT_EQ(pairs_of(5, {0, 10}, {16}), (Pairs{}));
    EXPECT_EQ(pairs_of(0, {0, 10}, {1, 10}), (Pairs{{10, 10}}));
}

TEST(StampPairs, NoImageIsWaitedForThatCannotBeNearer) {
    StampPairs<Stamp> pairs(5, 10);
    pairs.add(Eye::left, {0});
    pairs.add(Eye::right, {2});
    EXPECT_TRUE(pairs.take(false));
    pairs.add(Eye::left, {10});
    pairs.add(Eye::right, {14});
    EXPECT_FALSE(pairs.take(false)) << "a left one may come at 15";
    EXPECT_EQ(pairs.waiting(Eye::left), 1U);
    pairs.add(Eye::left, {20});
    EXPECT_TRUE(pairs.take(false));
}

TEST(StampPairs, AnEyeThatIsMissingHoldsNoMemory) {
    StampPairs<Stamp> pairs(5);
    for (int i = 0; i < 1000; ++i) {
        pairs.add(Eye::left, {100 * i});
        EXPECT_FALSE(pairs.take(false));
    }
    EXPECT_EQ(pairs.take_unpaired(), 1000U - 64);
    EXPECT_FALSE(pairs.take(true));
    EXPECT_EQ(pairs.take_unpaired(), 64U);
}

TEST(StampPairs, AnEyeThatStopsAfterAnImageHoldsNoMemory) {
    StampPairs<Stamp> pairs(5);
    pairs.add(Eye::left, {0});
    int found = 0;
    for (int i = 0; i < 1000; ++i) {
        pairs.add(Eye::right, {3 + 100 * i});
        while (pairs.take(false)) {
            ++found;
        }
    }
    EXPECT_EQ(found, 1);
    EXPECT_EQ(pairs.take_unpaired(), 999U - 64);
}

}  // namespace
}  // namespace disparityd::capture
