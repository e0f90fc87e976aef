// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

// C++17: the CUDA compiler reads this.
namespace disparityd {

/// Puts the lesser of two places into `low`, the greater into `high`.
struct Exchange {
    std::size_t low = 0;
    std::size_t high = 0;
};

/// Calls exchange({low, high}) for each step of merge exchange, which sorts `count` values in any order (D. E. Knuth,
/// The Art of Computer Programming 3, 5.2.2, algorithm M; Batcher's sorting network).
template <typename Visit>
constexpr void merge_exchange(std::size_t count, Visit exchange) {
    std::size_t top = 1;
    while (2 * top < count) {
        top *= 2;
    }
    for (std::size_t p = top; p > 0; p /= 2) {
        std::size_t residue = 0;
        std::size_t distance = p;
        for (std::size_t q = top;; q /= 2) {
            for (std::size_t i = 0; i + distance < count; ++i) {
                if ((i & p) == residue) {
                    exchange(Exchange{i, i + distance});
                }
            }
            if (q == p) {
                break;
            }
            distance = q - p;
            residue = p;
        }
    }
}

constexpr std::size_t exchanges_to_sort(std::size_t count) {
    std::size_t exchanges = 0;
    merge_exchange(count, [&](Exchange) { ++exchanges; });
    return exchanges;
}

/// Calls visit() for the steps that the value of rank `count` / 2 depends on, the last one first.
template <std::size_t count, typename Visit>
constexpr void steps_to_the_median_backwards(Visit visit) {
    std::array<Exchange, exchanges_to_sort(count)> all{};
    std::size_t filled = 0;
    merge_exchange(count, [&](Exchange exchange) { all[filled++] = exchange; });
    std::array<bool, count> needed{};
    needed[count / 2] = true;
    for (std::size_t i = all.size(); i-- > 0;) {
        if (needed[all[i].low] || needed[all[i].high]) {
            needed[all[i].low] = needed[all[i].high] = true;
            visit(all[i]);
        }
    }
}

template <std::size_t count>
constexpr std::size_t exchanges_to_the_median() {
    std::size_t exchanges = 0;
    steps_to_the_median_backwards<count>([&](Exchange) { ++exchanges; });
    return exchanges;
}

/// Returns the exchanges, in order, after which the median of `count` values (an odd number) lies in the middle.
template <std::size_t count>
constexpr std::array<Exchange, exchanges_to_the_median<count>()> median_network() {
    std::array<Exchange, exchanges_to_the_median<count>()> network{};
    std::size_t left = network.size();
    steps_to_the_median_backwards<count>([&](Exchange exchange) { network[--left] = exchange; });
    return network;
}

/// The same as a constant.
template <std::size_t count>
inline constexpr auto exchanges_for_median = median_network<count>();

}  // namespace disparityd
