// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include <gtest/gtest.h>

#include "kernels/cpu/sgm/sgm_sweeps.h"
#include "tests/kernels/any_pair.h"
#include "tests/kernels/guarded.h"

namespace disparityd::test {

/// A cache as large as no volume of the tests, so that all of them stay in it.
constexpr std::size_t in_cache = std::size_t{1} << 30;

/// What SGM leaves before post-processing, in guarded planes.
struct SgmResults {
    SgmResults(int width, int height)
        : disparity(width, height), confidence(width, height), winner(width, height), right_winner(width, height) {}

    cpu::WinnerPlanes view() const {
        return {disparity.plane(), confidence.plane(), winner.plane(), right_winner.plane()};
    }
    bool intact() const {
        return disparity.intact() && confidence.intact() && winner.intact() && right_winner.intact();
    }

    GuardedPlane<std::int16_t> disparity;
    GuardedPlane<std::uint8_t> confidence;
    GuardedPlane<std::int16_t> winner;
    GuardedPlane<std::int16_t> right_winner;
};

/// A pair, how it is matched, and what the reference finds.
class SgmCase {
public:
    SgmCase(Pair images, const MatchOptions& how)
        : pair(std::move(images)), options(how), expected(pair.width(), pair.height()) {
        run_reference();
    }

    /// Everything that SgmSweeps writes is as expected and nothing else is touched. `cache_bytes`: 0 has volumes
    /// written past the caches.
    void expect_from(std::int64_t target, std::size_t cache_bytes, Parallel& workers) const {
        const cpu::SgmSweeps sweeps(pair.width(), pair.height(), options, target, cache_bytes);
        const GuardedMemory<std::uint8_t> census(sweeps.census_bytes());
        const std::span<std::byte> planes(reinterpret_cast<std::byte*>(census.data()), census.size());
        const SgmResults found(pair.width(), pair.height());
        sweeps.census(pair.left.plane(), pair.right.plane(), planes, workers);
        sweeps.match(planes, pair.left.plane(), options, found.view(), workers);
        EXPECT_TRUE(census.intact());
        EXPECT_TRUE(found.intact());
        EXPECT_EQ(differences(found.winner.plane(), expected.winner.plane()), 0);
        EXPECT_EQ(differences(found.right_winner.plane(), expected.right_winner.plane()), 0);
        EXPECT_EQ(differences(found.disparity.plane(), expected.disparity.plane()), 0);
        EXPECT_EQ(differences(found.confidence.plane(), expected.confidence.plane()), 0);
        ASSERT_FALSE(testing::Test::HasFailure())
            << pair.width() << "x" << pair.height() << ", D " << options.range.count << " from " << options.range.first
            << ", " << options.sgm.paths << " paths, P1 " << options.sgm.p1 << ", P2 " << options.sgm.p2
            << (options.sgm.adaptive_p2 ? " adaptive, " : ", ") << workers.workers() << " workers, cache "
            << cache_bytes;
    }

    Pair pair;
    MatchOptions options;
    SgmResults expected;

private:
    void run_reference() const {
        const int width = pair.width();
        const int height = pair.height();
        const Rows rows = pair.left.rows();
        Image<std::uint64_t> left_words(width, height);
        Image<std::uint64_t> right_words(width, height);
        const CensusSteps& steps = reference::steps.matching.of(options.cost);
        steps.census(pair.left.plane(), left_words.plane(), rows);
        steps.census(pair.right.plane(), right_words.plane(), rows);
        const std::size_t candidates = pair.left.pixels().size() * static_cast<std::size_t>(options.range.count);
        std::vector<std::uint8_t> costs(candidates);
        std::vector<std::uint16_t> sums(candidates);
        std::vector<std::byte> scratch(reference::aggregate_scratch(width, height, options.range.count));
        const Volume<std::uint8_t> cost_volume{costs.data(), width, height, options.range.count};
        const Volume<std::uint16_t> sum_volume{sums.data(), width, height, options.range.count};
        Serial serial;
        steps.matching_cost(left_words.plane(), right_words.plane(), options.range, cost_volume, rows);
        reference::aggregate(cost_volume, pair.left.plane(), options.sgm, sum_volume, scratch, serial);
        reference::winner_left<std::uint16_t>(sum_volume, options.range, options.post.subpixel, expected.winner.plane(),
                                              expected.disparity.plane(), rows);
        reference::winner_right<std::uint16_t>(sum_volume, options.range, expected.right_winner.plane(), rows);
        reference::local_extrema<std::uint16_t>(sum_volume, options.range, options.post, expected.winner.plane(),
                                                expected.disparity.plane(), expected.confidence.plane(), rows);
    }

    template <typename T>
    static int differences(Plane<T> a, Plane<T> b) {
        int count = 0;
        for (int y = 0; y < a.height; ++y) {
            for (int x = 0; x < a.width; ++x) {
                count += a.at(x, y) == b.at(x, y) ? 0 : 1;
            }
        }
        return count;
    }
};

inline SgmCase random_case(Random& random, int width, int height, const MatchOptions& options) {
    return {Pair(random, width, height), options};
}

/// Any options of SGM with a P2 of min_p2 .. max_p2.
inline MatchOptions random_sgm_options(Random& random, int paths, int min_p2, int max_p2) {
    MatchOptions options;
    options.range = {pick(random, 0, 3) == 0 ? pick(random, -256, 256) : pick(random, -20, 20),
                     16 * pick(random, 1, 16)};
    options.cost = static_cast<CensusCost>(pick(random, 0, 1));
    options.sgm.paths = paths;
    options.sgm.p2 = pick(random, min_p2, max_p2);
    options.sgm.p1 = pick(random, 1, options.sgm.p2 - 1);
    options.sgm.adaptive_p2 = pick(random, 0, 1) == 1;
    options.sgm.p2_slope = pick(random, 1, 8);
    options.sgm.p2_min = pick(random, 0, 2) == 0 ? pick(random, 0, options.sgm.p2) : 0;
    options.post.subpixel = pick(random, 0, 3) > 0;
    options.post.local_extrema = pick(random, 0, 1) == 1;
    options.post.uniqueness = pick(random, 0, 1) * pick(random, 0, 99);
    return options;
}

}  // namespace disparityd::test
