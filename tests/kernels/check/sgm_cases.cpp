// SPDX-License-Identifier: Apache-2.0
// The kernels of SgmKernels one by one, and the sweeps made of them, beside the steps of the reference.
#include <algorithm>
#include <numeric>

#include "kernels/cpu/sgm/sgm_sweeps.h"
#include "tests/kernels/check/sgm_layout.h"

namespace disparityd::test {
namespace {

/// The reference's side of a case: everything from census to sums.
struct PlainSgm {
    explicit PlainSgm(const KernelInput& from)
        : input(from),
          random(from.seed),
          pair(random, from),
          left_words(from.width, from.height),
          right_words(from.width, from.height),
          costs(left_words.pixels().size() * static_cast<std::size_t>(from.options.range.count)),
          sums(costs.size()),
          scratch(reference::aggregate_scratch(from.width, from.height, from.options.range.count)) {}

    const CensusSteps& steps() const { return reference::steps.matching.of(input.options.cost); }
    Volume<std::uint8_t> cost_volume() { return volume(costs); }
    Volume<std::uint16_t> sum_volume() { return volume(sums); }

    void census() {
        if (const int coarseness = census_coarseness(input.options.noise_level); coarseness > 0) {
            over_parts(input, [&](Rows rows) {
                reference::noisy_census(pair.left.plane(), pair.smoothed_left.plane(), coarseness, left_words.plane(),
                                        rows);
                reference::noisy_census(pair.right.plane(), pair.smoothed_right.plane(), coarseness,
                                        right_words.plane(), rows);
            });
            return;
        }
        over_parts(input, [&](Rows rows) {
            steps().census(pair.left.plane(), left_words.plane(), rows);
            steps().census(pair.right.plane(), right_words.plane(), rows);
        });
    }
    void matching_cost() {
        over_parts(input, [&](Rows rows) {
            steps().matching_cost(left_words.plane(), right_words.plane(), input.options.range, cost_volume(), rows);
        });
    }
    void aggregate() {
        Serial serial;
        reference::aggregate(cost_volume(), pair.left.plane(), input.options.sgm, sum_volume(), scratch, serial);
    }
    void winners(const cpu::WinnerPlanes& out) {
        over_parts(input, [&](Rows rows) {
            const MatchOptions& options = input.options;
            reference::winner_left<std::uint16_t>(sum_volume(), options.range, options.post.subpixel, out.winner,
                                                  out.disparity, rows);
            reference::winner_right<std::uint16_t>(sum_volume(), options.range, out.right_winner, rows);
            reference::local_extrema<std::uint16_t>(sum_volume(), options.range, options.post, out.winner,
                                                    out.disparity, out.confidence, rows);
        });
    }

    template <typename T>
    Volume<T> volume(std::vector<T>& of) {
        return {of.data(), input.width, input.height, input.options.range.count};
    }

    KernelInput input;
    Random random;
    ImagePair pair;
    Image<std::uint64_t> left_words, right_words;
    std::vector<std::uint8_t> costs;
    std::vector<std::uint16_t> sums;
    std::vector<std::byte> scratch;
};

/// A vectorised side: kernels and guarded memory.
struct VectorSgm {
    VectorSgm(const KernelInput& from, std::int64_t target)
        : input(from), random(from.seed), pair(random, from), layout(from, target), planes(layout, buffers) {}

    /// Matching costs of all rows, in the reference's order.
    std::vector<std::uint8_t> costs() {
        const GuardedMemory<std::uint8_t> row(layout.geometry.row_bytes());
        std::vector<std::uint8_t> all;
        for (int y = 0; y < input.height; ++y) {
            planes.matching_cost(y, row.data());
            const std::vector<std::uint8_t> candidates = layout.costs_row(row.data());
            all.insert(all.end(), candidates.begin(), candidates.end());
        }
        return all;
    }

    KernelInput input;
    Random random;
    ImagePair pair;
    SgmLayout layout;
    RunBuffers buffers;
    SgmPlanes planes;
};

// The order of bits in census planes is free: what counts is the costs that they give.
KernelRun bind_census(const KernelInput& input, std::int64_t target) {
    if (target == 0) {
        const auto plain = std::make_shared<PlainSgm>(input);
        return {[plain] { plain->census(); },
                {},
                [plain] {
                    plain->matching_cost();
                    return plain->costs;
                },
                [] { return true; }};
    }
    const auto sgm = std::make_shared<VectorSgm>(input, target);
    return {[sgm] { sgm->planes.census(sgm->pair, sgm->input); },
            {},
            [sgm] { return sgm->costs(); },
            [sgm] { return sgm->buffers.intact(); }};
}

KernelRun bind_noisy_census(const KernelInput& input, std::int64_t target, int level) {
    KernelInput noisy = input;
    noisy.options.cost = CensusCost::census_7x5_gradient;
    noisy.options.noise_level = level;
    return bind_census(noisy, target);
}

// Downwards; on hostile input also upwards, and with jumps as between the halves of two sweeps.
std::vector<int> order_of_rows(const KernelInput& input) {
    std::vector<int> order(static_cast<std::size_t>(input.height));
    std::iota(order.begin(), order.end(), 0);
    if (input.hostile) {
        Random random(input.seed);
        switch (pick(random, 0, 2)) {
            case 1: std::reverse(order.begin(), order.end()); break;
            case 2: std::shuffle(order.begin(), order.end(), random); break;
            default: break;
        }
    }
    return order;
}

// With Store::stream, the costs that were streamed.
KernelRun bind_matching_cost(const KernelInput& input, std::int64_t target, cpu::Store store) {
    if (target == 0) {
        const auto plain = std::make_shared<PlainSgm>(input);
        plain->census();
        return {[plain] { plain->matching_cost(); }, {}, [plain] { return plain->costs; }, [] { return true; }};
    }
    const auto sgm = std::make_shared<VectorSgm>(input, target);
    sgm->planes.census(sgm->pair, input);
    const bool streams = store == cpu::Store::stream;
    const auto rows = sgm->buffers.memory<std::uint8_t>(sgm->layout.rows_bytes());
    const auto streamed = sgm->buffers.memory<std::uint8_t>(streams ? sgm->layout.rows_bytes() : 0);
    const auto row = [sgm](std::span<std::uint8_t> of, int y) {
        return of.data() + static_cast<std::size_t>(y) * sgm->layout.geometry.row_bytes();
    };
    return {[=, order = order_of_rows(input)] {
                for (const int y : order) {
                    sgm->planes.matching_cost(y, row(rows, y), streams ? row(streamed, y) : nullptr);
                }
            },
            {},
            [=] {
                std::vector<std::uint8_t> all;
                for (int y = 0; y < sgm->input.height; ++y) {
                    const auto candidates = sgm->layout.costs_row(row(streams ? streamed : rows, y));
                    all.insert(all.end(), candidates.begin(), candidates.end());
                }
                return all;
            },
            [sgm] { return sgm->buffers.intact(); }};
}

// Costs and sums of any origin, as far as they can come about.
KernelRun bind_winner(const KernelInput& input, std::int64_t target) {
    const auto plain = std::make_shared<PlainSgm>(input);
    const std::size_t candidates = plain->costs.size();
    constexpr int max_sum = 4 * cpu::max_byte_p2, max_cost = 62;
    constexpr int spreads[] = {1, 101, max_sum};
    const int spread = input.hostile ? spreads[pick(plain->random, 0, 2)] : 200;
    const bool large = input.hostile && pick(plain->random, 0, 1) == 1;  // all of them together
    const auto draw = [&](int most, bool from_above) {
        const int value = pick(plain->random, 0, std::min(most, spread));
        return static_cast<std::uint8_t>(from_above ? most - value : value);
    };
    std::vector<std::uint8_t> down(candidates), up(candidates);
    for (std::size_t i = 0; i < candidates; ++i) {
        down[i] = draw(max_sum, true);
        up[i] = draw(max_sum, large);
        plain->costs[i] = draw(max_cost, large);
        plain->sums[i] = static_cast<std::uint16_t>(down[i] + up[i] + 8 * plain->costs[i]);
    }
    const auto buffers = std::make_shared<RunBuffers>();
    const cpu::WinnerPlanes out = winner_planes(input, *buffers);
    if (target == 0) {
        return {[plain, out] { plain->winners(out); },
                {},
                [buffers] { return buffers->results(); },
                [buffers] { return buffers->intact(); }};
    }
    const auto layout = std::make_shared<SgmLayout>(input, target);
    const std::size_t row_bytes = layout->geometry.row_bytes();
    const std::span<std::uint8_t> rows[3] = {buffers->memory<std::uint8_t>(layout->rows_bytes()),
                                             buffers->memory<std::uint8_t>(layout->rows_bytes()),
                                             buffers->memory<std::uint8_t>(layout->rows_bytes())};
    const std::size_t row_candidates = candidates / static_cast<std::size_t>(input.height);
    for (std::size_t y = 0; y < static_cast<std::size_t>(input.height); ++y) {
        layout->lay_out(&down[y * row_candidates], 3, &rows[0][y * row_bytes]);
        layout->lay_out(&up[y * row_candidates], 5, &rows[1][y * row_bytes]);
        layout->lay_out_costs(&plain->costs[y * row_candidates], &rows[2][y * row_bytes]);
    }
    return {[layout, rows, out, input, row_bytes] {
                for (int y = 0; y < input.height; ++y) {
                    const std::size_t at = static_cast<std::size_t>(y) * row_bytes;
                    const cpu::SumRows sums{&rows[1][at], &rows[0][at], nullptr};
                    layout->kernels.winner(layout->geometry, input.options.post, sums, &rows[2][at], out.row(y));
                }
            },
            {},
            [buffers] { return buffers->results(); },
            [buffers] { return buffers->intact(); }};
}

/// All of it, from images to winners; `cache_bytes` 0 writes volumes past the caches.
KernelRun bind_sweeps(const KernelInput& input, std::int64_t target, std::size_t cache_bytes) {
    const auto plain = std::make_shared<PlainSgm>(input);
    const auto buffers = std::make_shared<RunBuffers>();
    const cpu::WinnerPlanes out = winner_planes(input, *buffers);
    const auto results = [buffers] { return buffers->results(); };
    const auto intact = [buffers] { return buffers->intact(); };
    if (target == 0) {
        return {[plain, out] {
                    plain->census();
                    plain->matching_cost();
                    plain->aggregate();
                    plain->winners(out);
                },
                {},
                results,
                intact};
    }
    const auto sweeps = std::make_shared<cpu::SgmSweeps>(input.width, input.height, input.options, target, cache_bytes);
    const auto planes = buffers->memory<std::byte>(sweeps->census_bytes());
    return {[plain, sweeps, planes, out] {
                Serial serial;
                sweeps->census(plain->pair.left.plane(), plain->pair.right.plane(), planes, serial);
                sweeps->match(planes, plain->pair.left.plane(), plain->input.options, out, serial);
            },
            {},
            results,
            intact};
}

}  // namespace

std::vector<KernelCase> sgm_cases() {
    constexpr std::size_t no_cache = 0, large_cache = std::size_t{1} << 40;
    const auto noisy_census = [](int level) {
        return
            [level](const KernelInput& input, std::int64_t target) { return bind_noisy_census(input, target, level); };
    };
    const auto kept_costs = [](const KernelInput& input, std::int64_t target) {
        return bind_matching_cost(input, target, cpu::Store::keep);
    };
    const auto streamed_costs = [](const KernelInput& input, std::int64_t target) {
        return bind_matching_cost(input, target, cpu::Store::stream);
    };
    const auto sweeps_in_cache = [](const KernelInput& input, std::int64_t target) {
        return bind_sweeps(input, target, large_cache);
    };
    const auto streamed_sweeps = [](const KernelInput& input, std::int64_t target) {
        return bind_sweeps(input, target, no_cache);
    };
    return {{"sgm/census", bind_census, 193, true},
            {"sgm/census_gradient", with_gradient_cost(bind_census), 193, true},
            {"sgm/noisy_census1", noisy_census(1), 193, true},
            {"sgm/noisy_census2", noisy_census(2), 193, true},
            {"sgm/matching_cost", kept_costs},
            {"sgm/matching_cost_streamed", streamed_costs},
            {"sgm/gradient_cost", with_gradient_cost(kept_costs)},
            {"sgm/gradient_cost_streamed", with_gradient_cost(streamed_costs)},
            {"sgm/winner", bind_winner},
            {"sgm/sweeps", sweeps_in_cache, cpu::max_byte_p2},
            {"sgm/sweeps_streamed", streamed_sweeps, cpu::max_byte_p2},
            {"sgm/sweeps_gradient", with_gradient_cost(sweeps_in_cache), cpu::max_byte_p2}};
}

}  // namespace disparityd::test
