// SPDX-License-Identifier: Apache-2.0
// Step 6 of docs/algorithm.md for one row: winners of both images, and the sums that steps 7 and 12 look at.
//
// Sums are words: class q = 0 .. 2 * registers - 1 holds the candidates 2 * registers * lane + q. They are made once,
// kept for 32 pixels in the first-level cache, and minima over all lanes are taken for 8 pixels at a time.
#if defined(DISPARITYD_CPU_WINNER_ROW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_WINNER_ROW_INL_H_
#undef DISPARITYD_CPU_WINNER_ROW_INL_H_
#else
#define DISPARITYD_CPU_WINNER_ROW_INL_H_
#endif

#include <algorithm>
#include <type_traits>

#include "kernels/cpu/least_of_pixels-inl.h"
#include "kernels/cpu/left_results-inl.h"
#include "kernels/cpu/rivals-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// Winners of the right image: the least sum along each diagonal, carried from pixel to pixel.
template <class Tag, int classes, int direction>
class RightWinners {
    using V = hn::Vec<Tag>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    static constexpr int candidates = classes * lanes;

public:
    RightWinners() {
        DISPARITYD_UNROLL
        for (int q = 0; q < classes; ++q) {
            least_[q] = none_;
            winner_[q] = no_winner_;
        }
    }

    /// Sums of the next pixel. The winner of the right pixel whose candidates are complete with it (the one that this
    /// pixel meets at the last candidate, direction 1, or at the first, direction -1) goes to *done; what is written
    /// beside it, lower entries (1) or higher ones (-1), means nothing.
    HWY_INLINE void add(const V* sums, const V* index, std::int16_t* done) {
        if constexpr (direction > 0) {
            const V least = from_lane_below(tag_, least_[classes - 1], none_);
            const V winner = from_lane_below(tag_, winner_[classes - 1], no_winner_);
            DISPARITYD_UNROLL
            for (int q = classes - 1; q > 0; --q) {
                winner_[q] = hn::IfThenElse(hn::Lt(sums[q], least_[q - 1]), index[q], winner_[q - 1]);
                least_[q] = hn::Min(sums[q], least_[q - 1]);
            }
            winner_[0] = hn::IfThenElse(hn::Lt(sums[0], least), index[0], winner);
            least_[0] = hn::Min(sums[0], least);
            hn::StoreU(upper_block(tag_, winner_[classes - 1]), block_, done - 7);
        } else {
            const V least = from_lane_above(tag_, least_[0], none_);
            const V winner = from_lane_above(tag_, winner_[0], no_winner_);
            DISPARITYD_UNROLL
            for (int q = 0; q < classes - 1; ++q) {
                winner_[q] = hn::IfThenElse(hn::Lt(least_[q + 1], sums[q]), winner_[q + 1], index[q]);
                least_[q] = hn::Min(sums[q], least_[q + 1]);
            }
            constexpr int last = classes - 1;
            winner_[last] = hn::IfThenElse(hn::Lt(least, sums[last]), winner, index[last]);
            least_[last] = hn::Min(sums[last], least);
            hn::StoreU(lower_block(tag_, winner_[0]), block_, done);
        }
    }

    /// The winners of right pixels on the way: entry k was met at candidate k by the last pixel.
    void rest(std::int16_t* winners) const {
        alignas(64) std::int16_t lane_winners[lanes];
        DISPARITYD_UNROLL
        for (int q = 0; q < classes; ++q) {
            hn::Store(winner_[q], tag_, lane_winners);
            for (int lane = 0; lane < lanes; ++lane) {
                winners[classes * lane + q] = lane_winners[lane];
            }
        }
    }

private:
    Tag tag_{};
    hn::FixedTag<std::int16_t, 8> block_{};
    V none_ = hn::Set(tag_, std::int16_t{no_sum - 1});  // less than the sum of what is no candidate
    V no_winner_ = hn::Set(tag_, std::int16_t{-1});
    V least_[classes];
    V winner_[classes];
};

/// `Sums` gives the sums of pixel x: sums(x, V* out); it is asked once for each pixel, in the order of the direction,
/// and may keep what it needs for the next one.
template <class Tag, int classes, int direction, class Sums>
class WinnerSearch {
    using V = hn::Vec<Tag>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    static constexpr int candidates = classes * lanes;
    static constexpr int at_once = 32;

public:
    WinnerSearch(const SgmGeometry& geometry, const Sums& sums)
        : width_(geometry.width), range_(geometry.range), sums_of_(sums), places_(range_.count) {
        DISPARITYD_UNROLL
        for (int q = 0; q < classes; ++q) {
            alignas(64) std::int16_t k[lanes];
            alignas(64) std::int16_t pad[lanes];
            for (int lane = 0; lane < lanes; ++lane) {
                k[lane] = static_cast<std::int16_t>(classes * lane + q);
                pad[lane] = k[lane] < range_.count ? std::int16_t{0} : no_sum;
            }
            index_[q] = hn::Load(tag_, k);
            padding_[q] = hn::Load(tag_, pad);
        }
    }

    void run(Minima& minima, std::int16_t* right_winner) {
        std::fill_n(right_row_ + right_origin, width_, std::int16_t{-1});
        const int batches = (width_ + at_once - 1) / at_once;
        for (int batch = 0; batch < batches; ++batch) {
            const int x = (direction > 0 ? batch : batches - 1 - batch) * at_once;
            const int count = std::min(at_once, width_ - x);
            sums_and_right(x, count, minima.least + x);
            winners(minima.least + x, count, minima.winner + x);
            neighbours(x, count, minima);
            second(count, minima.winner + x, minima.second + x);
        }
        finish_right(right_winner);
    }

private:
    // Right pixels from beyond the right end of the image to left of it, so that nothing needs to ask where one is.
    // Backwards, because then what is written too much is written over later.
    static constexpr int right_origin = 2 * max_disparities;
    static constexpr int right_size = max_side + 4 * max_disparities;

    std::int16_t* sums(int i) { return sums_ + i * candidates; }

    // The right pixel that left pixel x meets at candidate k, as an index of right_row_.
    int right_entry(int x, int k) const { return right_origin + width_ - 1 - (x - range_.first - k); }

    HWY_INLINE void sums_and_right(int x, int count, std::int16_t* least) {
        // Copies that nobody else can see stay in registers.
        RightWinners<Tag, classes, direction> right = right_;
        Sums sums_of = sums_of_;
        V index[classes];
        std::copy_n(index_, classes, index);
        for (int n = 0; n < count; ++n) {
            const int i = direction > 0 ? n : count - 1 - n;
            V s[classes];
            sums_of(x + i, s);
            if (range_.count != candidates) {
                DISPARITYD_UNROLL
                for (int q = 0; q < classes; ++q) {
                    s[q] = hn::Or(s[q], padding_[q]);
                }
            }
            V m = s[0];
            V first = index[0];
            hn::Store(s[0], tag_, sums(i));
            DISPARITYD_UNROLL
            for (int q = 1; q < classes; ++q) {
                first = hn::IfThenElse(hn::Lt(s[q], m), index[q], first);
                m = hn::Min(m, s[q]);
                hn::Store(s[q], tag_, sums(i) + q * lanes);
            }
            hn::Store(m, tag_, by_lane_ + i * lanes);
            hn::Store(first, tag_, first_ + i * lanes);
            right.add(s, index, right_row_ + right_entry(x + i, direction > 0 ? candidates - 1 : 0));
        }
        right_ = right;
        if constexpr (std::is_copy_assignable_v<Sums>) {  // a closure is not, and keeps nothing
            sums_of_ = sums_of;
        }
        least_of_lanes(count, least);
    }

    // The least lane of each vector of by_lane_.
    HWY_INLINE void least_of_lanes(int count, std::int16_t* least) {
        const hn::FixedTag<std::int16_t, 8> block;
        DISPARITYD_UNROLL
        for (int i = 0; i < count; i += 8) {
            hn::StoreU(least_of_pixels(tag_, [&](int k) { return hn::Load(tag_, by_lane_ + (i + k) * lanes); }), block,
                       least + i);
        }
    }

    // The first candidate with the least sum of its lane, in the first lane that has the least of all.
    HWY_INLINE void winners(const std::int16_t* least, int count, std::int16_t* winner) {
        for (int i = 0; i < count; ++i) {
            const auto found = hn::Eq(hn::Load(tag_, by_lane_ + i * lanes), hn::Set(tag_, least[i]));
            winner[i] = first_[i * lanes + hn::FindFirstTrue(tag_, found)];
        }
    }

    HWY_INLINE void neighbours(int x, int count, Minima& minima) {
        DISPARITYD_UNROLL
        for (int i = 0; i < count; ++i) {
            take_neighbours(places_, minima.winner[x + i], no_sum, sums(i), &minima.before[x + i],
                            &minima.after[x + i]);
        }
    }

    HWY_INLINE void second(int count, const std::int16_t* winner, std::int16_t* least) {
        for (int i = 0; i < count; ++i) {
            hn::Store(least_rivals<classes>(tag_, sums(i), winner[i], no_sum), tag_, by_lane_ + i * lanes);
        }
        least_of_lanes(count, least);
    }

    void finish_right(std::int16_t* right_winner) {
        std::int16_t rest[candidates];
        right_.rest(rest);
        const int x = direction > 0 ? width_ - 1 : 0;
        for (int k = 0; k < candidates; ++k) {
            right_row_[right_entry(x, k)] = rest[k];
        }
        const std::int16_t* found = right_row_ + right_origin + width_ - 1;
        for (int i = 0; i < width_; ++i) {
            // Where no candidate was met: -1, one less than the first candidate.
            right_winner[i] = static_cast<std::int16_t>(found[-i] + range_.first);
        }
    }

    Tag tag_{};
    int width_;
    DisparityRange range_;
    Sums sums_of_;
    CandidatePlaces<classes, lanes> places_;
    V index_[classes];
    V padding_[classes];
    RightWinners<Tag, classes, direction> right_;
    alignas(64) std::int16_t sums_[at_once * candidates];
    alignas(64) std::int16_t by_lane_[at_once * lanes] = {};
    alignas(64) std::int16_t first_[at_once * lanes];
    std::int16_t right_row_[right_size];
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
