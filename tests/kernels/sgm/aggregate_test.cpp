// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <tuple>

#include <gtest/gtest.h>

#include "tests/kernels/support.h"

namespace disparityd::test {
namespace {

struct Costs {
    Costs(Random& random, int width, int height, int disparities, int most = 62)
        : values(noise(random, width * disparities, height, 0, most).pixels()),
          volume{values.data(), width, height, disparities} {}
    std::vector<std::uint8_t> values;
    Volume<const std::uint8_t> volume;
};

std::vector<std::uint16_t> aggregate(const Costs& costs, const Image<std::uint8_t>& left, const SgmOptions& options,
                                     Parallel& workers) {
    const auto& volume = costs.volume;
    std::vector<std::uint16_t> sums(costs.values.size(), 999);
    std::vector<std::byte> scratch(reference::aggregate_scratch(volume.width, volume.height, volume.disparities),
                                   std::byte{0x5a});
    reference::aggregate(volume, left.plane(), options, {sums.data(), volume.width, volume.height, volume.disparities},
                         scratch, workers);
    return sums;
}

// The recursion as the paper writes it: top down, pixel by pixel, in int, each path cost found once and remembered.
class SlowSgm {
public:
    SlowSgm(const Costs& costs, const Image<std::uint8_t>& left, const SgmOptions& options)
        : costs_(costs.volume), left_(left), options_(options) {}

    int sum(int x, int y, int d) {
        int total = 0;
        for (int dy = -1; dy <= 1; ++dy) {
            for (int dx = -1; dx <= 1; ++dx) {
                const int steps = std::abs(dx) + std::abs(dy);
                if (steps == 1 || (steps == 2 && options_.paths == 8)) {
                    total += path(dx, dy, x, y)[static_cast<std::size_t>(d)];
                }
            }
        }
        return total;
    }

private:
    const std::vector<int>& path(int dx, int dy, int x, int y) {
        const auto key = std::tuple{dx, dy, x, y};
        if (const auto known = known_.find(key); known != known_.end()) {
            return known->second;
        }
        const int count = costs_.disparities;
        std::vector<int> result(costs_.pixel(x, y), costs_.pixel(x, y) + count);
        const int px = x - dx;
        const int py = y - dy;
        if (px >= 0 && py >= 0 && px < costs_.width && py < costs_.height) {
            const std::vector<int>& before = path(dx, dy, px, py);
            const int least = *std::min_element(before.begin(), before.end());
            int p2 = options_.p2;
            if (options_.adaptive_p2) {
                const int difference = std::abs(int{left_.at(x, y)} - int{left_.at(px, py)});
                p2 = std::max({options_.p1 + 1, options_.p2_min, p2 - options_.p2_slope * difference});
            }
            for (int d = 0; d < count; ++d) {
                int best = least + p2;
                for (int i = 0; i < count; ++i) {
                    const int penalty = i == d ? 0 : std::abs(i - d) == 1 ? options_.p1 : p2;
                    best = std::min(best, before[static_cast<std::size_t>(i)] + penalty);
                }
                result[static_cast<std::size_t>(d)] += best - least;
            }
        }
        return known_[key] = result;
    }

    Volume<const std::uint8_t> costs_;
    const Image<std::uint8_t>& left_;
    SgmOptions options_;
    std::map<std::tuple<int, int, int, int>, std::vector<int>> known_;
};

TEST(Aggregate, EqualsTheRecursionWrittenDifferently) {
    Random random(7);
    Serial serial;
    for (const auto& [width, height] : {std::pair{11, 7}, {1, 1}, {1, 9}, {13, 1}, {4, 12}, {2, 2}}) {
        for (const int paths : {4, 8}) {
            for (const bool adaptive : {false, true}) {
                for (const auto& [p1, p2] : {std::pair{10, 63}, {1, 2}, {192, 193}, {1, 193}, {60, 70}}) {
                    const Costs costs(random, width, height, pick(random, 0, 1) == 0 ? 16 : 48);
                    const Image<std::uint8_t> left = noise(random, width, height);
                    const SgmOptions options{paths, p1, p2, adaptive, pick(random, 1, 8), pick(random, 0, p2)};
                    const std::vector<std::uint16_t> sums = aggregate(costs, left, options, serial);
                    SlowSgm slow(costs, left, options);
                    std::size_t i = 0;
                    for (int y = 0; y < height; ++y) {
                        for (int x = 0; x < width; ++x) {
                            for (int d = 0; d < costs.volume.disparities; ++d) {
                                ASSERT_EQ(sums[i++], slow.sum(x, y, d)) << x << "," << y << " d " << d << " paths "
                                                                        << paths << " p1 " << p1 << " p2 " << p2;
                            }
                        }
                    }
                }
            }
        }
    }
}

TEST(Aggregate, OnePathByHand) {
    // 3 pixels in a row; columns have no second pixel, so vertical paths add C itself, twice.
    Random random(8);
    Costs costs(random, 3, 1, 16);
    std::fill(costs.values.begin(), costs.values.end(), std::uint8_t{40});
    costs.values[2] = 0;        // pixel 0 prefers d = 2
    costs.values[16 + 3] = 30;  // pixel 1 prefers d = 3, weakly
    Serial serial;
    const auto sums = aggregate(costs, Image<std::uint8_t>(3, 1, 0), {4, 5, 20, false}, serial);
    // Rightwards at pixel 1: d = 2: 40 + 0; d = 3: 30 + 5; d = 1: 40 + 5; others: 40 + 20.
    // Leftwards at pixel 1, pixel 2 is flat: 40 (30 at d = 3), nothing added.
    EXPECT_EQ(sums[16 + 2], 40 + 40 + 2 * 40);
    EXPECT_EQ(sums[16 + 3], 35 + 30 + 2 * 30);
    EXPECT_EQ(sums[16 + 1], 45 + 40 + 2 * 40);
    EXPECT_EQ(sums[16 + 9], 60 + 40 + 2 * 40);
}

TEST(Aggregate, LargestCostsAndPenaltiesFitAByte) {
    // A row that agrees on d = 10: elsewhere the path costs grow to the largest there are, 62 + P2 = 255.
    Random random(9);
    Costs costs(random, 11, 1, 16);
    std::fill(costs.values.begin(), costs.values.end(), std::uint8_t{62});
    for (std::size_t pixel = 0; pixel < 11; ++pixel) {
        costs.values[16 * pixel + 10] = 0;
    }
    Serial serial;
    const auto sums = aggregate(costs, Image<std::uint8_t>(11, 1, 0), {8, 192, 193, false}, serial);
    EXPECT_EQ(sums[16 * 5 + 0], 2 * 255 + 6 * 62);
    EXPECT_EQ(sums[16 * 5 + 9], 2 * (62 + 192) + 6 * 62);
    EXPECT_EQ(sums[16 * 5 + 10], 0);
    EXPECT_EQ(sums[16 * 2 + 0], 186 + 255 + 6 * 62);  // the third pixel rightwards
}

TEST(Aggregate, IsTheSameForAnyNumberOfWorkersInAnyOrder) {
    Random random(10);
    for (int round = 0; round < 20; ++round) {
        const int width = pick(random, 1, 40);
        const int height = pick(random, 1, 30);
        const Costs costs(random, width, height, 16 * pick(random, 1, 3));
        const Image<std::uint8_t> left = noise(random, width, height);
        const SgmOptions options{pick(random, 0, 1) == 0 ? 4 : 8, 12, 90, pick(random, 0, 1) == 1};
        Serial serial;
        const auto expected = aggregate(costs, left, options, serial);
        for (const int count : {2, 3, 7}) {
            ShuffledWorkers workers(count, static_cast<unsigned>(random()));
            ASSERT_EQ(aggregate(costs, left, options, workers), expected) << width << "x" << height;
        }
    }
}

}  // namespace
}  // namespace disparityd::test
