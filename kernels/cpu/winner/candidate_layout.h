// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace disparityd::cpu {

/// Where the sum of each candidate of a pixel lies (match_layout.h): candidate stride * lane + q, of residue q, at
/// q * lanes + lane.
template <int stride, int lanes>
class CandidateLayout {
public:
    static constexpr int candidates = stride * lanes;

    /// `count`: number of candidates that count, at least 3.
    explicit CandidateLayout(int count) {
        if (count != candidates) {
            std::copy_n(all.begin(), count + 1, some_);
            some_[count + 1] = all[static_cast<std::size_t>(count) - 1];
            places_ = some_;
        }
    }
    CandidateLayout(const CandidateLayout&) = delete;
    CandidateLayout& operator=(const CandidateLayout&) = delete;

    static constexpr std::uint16_t of(int k) { return static_cast<std::uint16_t>(k % stride * lanes + k / stride); }

    /// Returns where candidates k - 1, k and k + 1 lie. At an end of the range the neighbour that exists stands for
    /// both.
    const std::uint16_t* neighbours(int k) const { return places_ + k; }

    /// The candidate at each place.
    struct Numbers {
        alignas(64) std::int16_t at[candidates];
    };
    static constexpr Numbers numbers = [] {
        Numbers all_places = {};
        for (int k = 0; k < candidates; ++k) {
            all_places.at[of(k)] = static_cast<std::int16_t>(k);
        }
        return all_places;
    }();

private:
    using Table = std::array<std::uint16_t, candidates + 2>;

    static constexpr Table make() {
        Table places = {};
        for (int k = 0; k < candidates; ++k) {
            places[static_cast<std::size_t>(k) + 1] = of(k);
        }
        places[0] = places[2];
        places[candidates + 1] = places[candidates - 1];
        return places;
    }

    static constexpr Table all = make();  // entry k + 1: of candidate k
    std::uint16_t some_[candidates + 2];
    const std::uint16_t* places_ = all.data();
};

}  // namespace disparityd::cpu
