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

#include "kernels/cpu/least_of_pixels-inl.h"
#include "kernels/cpu/left_results-inl.h"
#include "kernels/cpu/rivals-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// What candidate k is called in a search: less than 0, so that 0 can stand for what was not found.
constexpr std::int16_t name_of_candidate(int k) {
    return static_cast<std::int16_t>(k - max_disparities);
}

/// The names of all candidates, class after class.
template <int classes, int lanes>
struct CandidateNames {
    using Places = CandidatePlaces<classes, lanes>;
    alignas(64) std::int16_t names[Places::candidates] = {};

    constexpr CandidateNames() {
        for (int k = 0; k < Places::candidates; ++k) {
            names[Places::of(k)] = name_of_candidate(k);
        }
    }
};
template <int classes, int lanes>
inline constexpr CandidateNames<classes, lanes> candidate_names;

/// Sums for WinnerSearch::run() from those of one pixel: sums_of(x, std::int16_t* to).
template <int candidates, class SumsOf>
auto pixel_by_pixel(SumsOf sums_of) {
    return [sums_of](int x, int count, std::int16_t* to) {
        for (int i = 0; i < count; ++i) {
            sums_of(x + i, to + i * candidates);
        }
    };
}

/// Winners of the right image: the least sum along each diagonal, carried from pixel to pixel.
template <class Tag, int classes>
class RightWinners {
    using V = hn::Vec<Tag>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    static constexpr int last_class = classes - 1;

public:
    RightWinners() {
        DISPARITYD_UNROLL
        for (int q = 0; q < classes; ++q) {
            least_[q] = none();
            winner_[q] = no_winner();
        }
    }

    /// Sums of the next pixel to the right, and the names of its candidates. The name of the winner of the right pixel
    /// whose candidates are complete with it (the one that this pixel meets at the last candidate) goes to *done; what
    /// is written to lower entries means nothing.
    HWY_INLINE void add(const V* sums, const V* name, std::int16_t* done) {
        const V least = from_lane_below(tag_, least_[last_class], none());
        const V winner = from_lane_below(tag_, winner_[last_class], no_winner());
        DISPARITYD_UNROLL
        for (int q = last_class; q > 0; --q) {
            winner_[q] = hn::IfThenElse(hn::Lt(sums[q], least_[q - 1]), name[q], winner_[q - 1]);
            least_[q] = hn::Min(sums[q], least_[q - 1]);
        }
        winner_[0] = hn::IfThenElse(hn::Lt(sums[0], least), name[0], winner);
        least_[0] = hn::Min(sums[0], least);
        hn::StoreU(upper_block(tag_, winner_[last_class]), block_, done - 7);
    }

    /// The winners of right pixels on the way: entry k was met at candidate k by the last pixel.
    HWY_INLINE void rest(std::int16_t* winners) const {
        DISPARITYD_UNROLL
        for (int q = 0; q < classes; ++q) {
            alignas(64) std::int16_t lane_winners[lanes];
            hn::Store(winner_[q], tag_, lane_winners);
            for (int lane = 0; lane < lanes; ++lane) {
                winners[classes * lane + q] = lane_winners[lane];
            }
        }
    }

private:
    // Less than the sum of what is no candidate.
    static HWY_INLINE V none() { return hn::Set(Tag(), std::int16_t{no_sum - 1}); }
    static HWY_INLINE V no_winner() { return hn::Set(Tag(), name_of_candidate(-1)); }

    Tag tag_{};
    hn::FixedTag<std::int16_t, 8> block_{};
    V least_[classes];
    V winner_[classes];
};

template <class Tag, int classes>
class WinnerSearch {
    using V = hn::Vec<Tag>;
    using Right = RightWinners<Tag, classes>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    static constexpr int candidates = classes * lanes;
    static constexpr int at_once = 32;

public:
    explicit WinnerSearch(const SgmGeometry& geometry)
        : width_(geometry.width), range_(geometry.range), places_(range_.count) {
        for (int k = 0; k < candidates && range_.count != candidates; ++k) {
            padding_[Places::of(k)] = k < range_.count ? std::int16_t{0} : no_sum;
        }
        std::fill_n(first_, at_once * lanes, name_of_candidate(0));  // of pixels past the end of the row too
    }

    /// sums(x, count, std::int16_t* to) gives the sums of pixels x .. x + count - 1, one pixel after the other; it is
    /// asked for each pixel once, from left to right.
    template <class Sums>
    void run(Sums sums, Minima& minima, std::int16_t* right_winner) {
        std::fill_n(right_row_ + right_origin, width_, name_of_candidate(-1));
        Right right;
        for (int x = 0; x < width_; x += at_once) {
            const int count = std::min(at_once, width_ - x);
            sums(x, count, sums_);
            std::fill(sums_of(count), sums_of((count + 7) / 8 * 8), std::int16_t{0});  // searched in eights
            if (range_.count != candidates) {
                set_padding(count);
            }
            least_and_right(x, count, right);
            winners(count, minima.least + x, minima.winner + x);
            neighbours(x, count, minima);
            second(count, minima.winner + x, minima.second + x);
        }
        finish_right(right, right_winner);
    }

private:
    using Places = CandidatePlaces<classes, lanes>;

    // Right pixels from beyond the right end of the image to left of it, so that nothing needs to ask where one is.
    // Backwards, because then what is written too much is written over later.
    static constexpr int right_origin = 2 * max_disparities;
    static constexpr int right_size = max_side + 4 * max_disparities;

    std::int16_t* sums_of(int i) { return sums_ + i * candidates; }

    // The right pixel that left pixel x meets at candidate k, as an index of right_row_.
    int right_entry(int x, int k) const { return right_origin + width_ - 1 - (x - range_.first - k); }

    void set_padding(int count) {
        for (int i = 0; i < count; ++i) {
            for (int at = 0; at < candidates; at += lanes) {
                const V sums = hn::Load(tag_, sums_of(i) + at);
                hn::Store(hn::Or(sums, hn::Load(tag_, padding_ + at)), tag_, sums_of(i) + at);
            }
        }
    }

    HWY_INLINE void least_and_right(int x, int count, Right& right) {
        V name[classes];
        DISPARITYD_UNROLL
        for (int q = 0; q < classes; ++q) {
            name[q] = hn::Load(tag_, candidate_names<classes, lanes>.names + q * lanes);
        }
        std::int16_t* done = right_row_ + right_entry(x, candidates - 1);
        for (int i = 0; i < count; ++i) {
            V s[classes];
            DISPARITYD_UNROLL
            for (int q = 0; q < classes; ++q) {
                s[q] = hn::Load(tag_, sums_of(i) + q * lanes);
            }
            V least = s[0];
            V first = name[0];
            DISPARITYD_UNROLL
            for (int q = 1; q < classes; ++q) {
                first = hn::IfThenElse(hn::Lt(s[q], least), name[q], first);
                least = hn::Min(least, s[q]);
            }
            hn::Store(least, tag_, by_lane_ + i * lanes);
            hn::Store(first, tag_, first_ + i * lanes);
            right.add(s, name, done - i);
        }
    }

    // Of each pixel the least sum of all lanes, and the first candidate that has it.
    HWY_INLINE void winners(int count, std::int16_t* least, std::int16_t* winner) {
        const auto none = hn::Set(block_, static_cast<std::int16_t>(-name_of_candidate(0)));
        for (int i = 0; i < count; i += 8) {
            const auto sums = [&](int k) { return hn::Load(tag_, by_lane_ + (i + k) * lanes); };
            hn::StoreU(least_of_pixels(tag_, sums), block_, least + i);
            const auto names = [&](int k) {
                const auto found = hn::Eq(sums(k), hn::Set(tag_, least[i + k]));
                return hn::IfThenElseZero(found, hn::Load(tag_, first_ + (i + k) * lanes));
            };
            hn::StoreU(hn::Add(least_of_pixels(tag_, names), none), block_, winner + i);
        }
    }

    HWY_INLINE void neighbours(int x, int count, Minima& minima) {
        for (int i = 0; i < count; ++i) {
            take_neighbours<no_sum>(places_, minima.winner[x + i], sums_of(i), &minima.before[x + i],
                                    &minima.after[x + i]);
        }
    }

    HWY_INLINE void second(int count, const std::int16_t* winner, std::int16_t* least) {
        for (int i = 0; i < count; i += 8) {
            const auto rivals = [&](int k) {
                return least_rivals<no_sum, classes>(tag_, sums_of(i + k), winner[i + k]);
            };
            hn::StoreU(least_of_pixels(tag_, rivals), block_, least + i);
        }
    }

    HWY_INLINE void finish_right(const Right& right, std::int16_t* right_winner) {
        std::int16_t rest[candidates];
        right.rest(rest);
        for (int k = 0; k < candidates; ++k) {
            right_row_[right_entry(width_ - 1, k)] = rest[k];
        }
        const std::int16_t* found = right_row_ + right_origin + width_ - 1;
        for (int i = 0; i < width_; ++i) {
            // Where no candidate was met: -1, one less than the first candidate.
            right_winner[i] = static_cast<std::int16_t>(found[-i] - name_of_candidate(-range_.first));
        }
    }

    Tag tag_{};
    hn::FixedTag<std::int16_t, 8> block_{};
    int width_;
    DisparityRange range_;
    Places places_;
    alignas(64) std::int16_t padding_[candidates];
    alignas(64) std::int16_t sums_[at_once * candidates];
    alignas(64) std::int16_t by_lane_[at_once * lanes] = {};
    alignas(64) std::int16_t first_[at_once * lanes];
    std::int16_t right_row_[right_size];
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
