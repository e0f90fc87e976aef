// SPDX-License-Identifier: Apache-2.0
// Winners of the right image. A right pixel is candidate k of one left pixel and candidate k + 1 of the next one. So
// the least key of a residue group is carried from residue to residue, and the running minimum after a group waits
// until the left pixel comes for which the right pixel is in the next group.
#if defined(DISPARITYD_CPU_WINNER_RIGHT_WINNERS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_WINNER_RIGHT_WINNERS_INL_H_
#undef DISPARITYD_CPU_WINNER_RIGHT_WINNERS_INL_H_
#else
#define DISPARITYD_CPU_WINNER_RIGHT_WINNERS_INL_H_
#endif

#include <algorithm>

#include "kernels/cpu/simd/transpose_min-inl.h"
#include "kernels/cpu/winner/running_argmin-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// Takes the keys of a residue group at one more pixel. Returns the least keys of the right pixels for which the group
/// is complete with it. `least` has the least keys of the others, by the last residue that they had.
template <int group_size, class V>
HWY_INLINE V min_of_group(const V* keys, V* least) {
    const V whole = hn::Min(keys[group_size - 1], least[group_size - 2]);
    DISPARITYD_UNROLL
    for (int q = group_size - 2; q > 0; --q) {
        least[q] = hn::Min(keys[q], least[q - 1]);
    }
    least[0] = keys[0];
    return whole;
}

/// For any number of groups: running minima wait in memory.
template <class Tag, int stride, int at_once>
class RightWinnersInMemory {
    using V = hn::Vec<Tag>;
    using Argmin = RunningArgmin<Tag, stride>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    using Groups = ResidueGroups<stride>;
    static constexpr int groups = Groups::count;
    static constexpr int group_size = Groups::largest;
    static constexpr int smaller_size = Groups::size(groups - 1);

public:
    /// What stays in registers for a block: least keys of groups that are not complete yet, by their last residue.
    struct State {
        // Written out: GCC compiles an implicit one for the baseline.
        State() {}

        V least[groups][group_size - 1];
    };

    RightWinnersInMemory() {
        for (auto& of_group : waiting_) {
            for (int i = 0; i < group_size; ++i) {
                hn::Store(hn::Set(Tag(), Argmin::no_sum), Tag(), of_group[i].sums);
                hn::Store(hn::Set(Tag(), Argmin::no_candidate), Tag(), of_group[i].candidates);
            }
        }
        DISPARITYD_UNROLL
        for (auto& of_group : state_.least) {
            std::fill_n(of_group, group_size - 1, hn::Set(Tag(), no_key));
        }
    }

    State state() const { return state_; }

    /// Keeps what the block's pixels have made of it. In line, since what other functions may see does not stay in
    /// registers.
    HWY_INLINE void keep(const State& state) { state_ = state; }

    /// Takes the keys of the i-th pixel of a block.
    HWY_INLINE void add(const V* keys, int i, State& state) {
        DISPARITYD_UNROLL
        for (int group = 0; group < groups; ++group) {
            const V* of_group = keys + Groups::begin(group);
            V* least = state.least[group];
            Argmin argmin = entering(group, i);
            argmin.update(Groups::size(group) == group_size ? min_of_group<group_size>(of_group, least)
                                                            : min_of_group<smaller_size>(of_group, least),
                          group);
            Waiting& waits = waiting_[group][i + group_size];
            hn::Store(argmin.sum, Tag(), waits.sums);
            hn::Store(argmin.candidate, Tag(), waits.candidates);
        }
    }

    /// Writes the winners of the right pixels whose candidates are complete with the i-th pixel (where they are the
    /// last candidate) and the seven pixels after it, in reverse.
    HWY_INLINE void finished(int i, std::uint16_t* winners) const {
        const hn::FixedTag<std::uint16_t, 8> block;
        const Waiting* waits = waiting_[groups - 1] + group_size + i;
        const auto last_lanes = [&](int k) { return hn::Load(block, waits[7 - k].candidates + lanes - 8); };
        hn::StoreU(last_lanes_side_by_side(block, last_lanes), block, winners);
    }

    /// After a whole block.
    void next_block() {
        for (auto& of_group : waiting_) {
            DISPARITYD_UNROLL
            for (int i = 0; i < group_size; ++i) {
                const Waiting& last = of_group[at_once + i];
                hn::Store(hn::Load(Tag(), last.sums), Tag(), of_group[i].sums);
                hn::Store(hn::Load(Tag(), last.candidates), Tag(), of_group[i].candidates);
            }
        }
    }

    /// After the last block, of `count` pixels: writes the winners of right pixels that are not complete. Entry k is
    /// candidate k of the last pixel.
    void rest(int count, std::uint16_t* winners) const {
        for (int group = 0; group < groups; ++group) {
            const int size = Groups::size(group);
            for (int q = 0; q < size; ++q) {
                alignas(64) std::uint16_t of_lanes[lanes];
                if (q == size - 1) {
                    std::copy_n(waiting_[group][count - 1 + group_size].candidates, lanes, of_lanes);
                } else {
                    Argmin argmin = entering(group, count - 1 + (size - 1 - q));
                    argmin.update(state_.least[group][q], group);
                    hn::Store(argmin.candidate, Tag(), of_lanes);
                }
                for (int lane = 0; lane < lanes; ++lane) {
                    winners[stride * lane + Groups::begin(group) + q] = of_lanes[lane];
                }
            }
        }
    }

private:
    // The running minimum of each lane after a group, until the right pixel is in the next group.
    struct Waiting {
        alignas(2 * lanes) std::uint16_t sums[lanes];
        alignas(2 * lanes) std::uint16_t candidates[lanes];
    };

    // The running minimum with which a group begins that is complete with the i-th pixel. Candidates of a lane follow
    // those of the lane below; not by a load that is moved by a lane, since that would wait until the stores before it
    // have left the core.
    HWY_INLINE Argmin entering(int group, int i) const {
        const Waiting& waits = waiting_[(group + groups - 1) % groups][i + group_size - Groups::size(group)];
        const V sum = hn::Load(Tag(), waits.sums);
        const V candidate = hn::Load(Tag(), waits.candidates);
        if (group > 0) {
            return {sum, candidate};
        }
        return Argmin::from_lane_below(sum, candidate);
    }

    State state_;
    Waiting waiting_[groups][at_once + group_size];
};

/// For one group, and many registers: running minima wait in them. Of a pixel a block is stored, instead of two vectors
/// that are stored and loaded again.
template <class Tag, int stride, int at_once>
class RightWinnersInRegisters {
    using V = hn::Vec<Tag>;
    using Argmin = RunningArgmin<Tag, stride>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    static_assert(ResidueGroups<stride>::count == 1);

public:
    /// What stays in registers for a block.
    struct State {
        State() {}  // written out as above

        V least[stride - 1];  ///< keys of right pixels that are not complete yet, by their last residue
        // Running minima, for the pixel that comes as many later.
        V sum[stride];
        V candidate[stride];
    };

    RightWinnersInRegisters() {
        DISPARITYD_UNROLL
        for (int q = 0; q < stride; ++q) {
            state_.sum[q] = hn::Set(Tag(), Argmin::no_sum);
            state_.candidate[q] = hn::Set(Tag(), Argmin::no_candidate);
        }
        std::fill_n(state_.least, stride - 1, hn::Set(Tag(), no_key));
    }

    State state() const { return state_; }
    HWY_INLINE void keep(const State& state) { state_ = state; }

    HWY_INLINE void add(const V* keys, int i, State& state) {
        Argmin argmin = Argmin::from_lane_below(state.sum[0], state.candidate[0]);
        argmin.update(min_of_group<stride>(keys, state.least), 0);
        DISPARITYD_UNROLL
        for (int q = 0; q + 1 < stride; ++q) {
            state.sum[q] = state.sum[q + 1];
            state.candidate[q] = state.candidate[q + 1];
        }
        state.sum[stride - 1] = argmin.sum;
        state.candidate[stride - 1] = argmin.candidate;
        hn::Store(last_block(Tag(), argmin.candidate), block_, complete_ + 8 * i);
    }

    HWY_INLINE void finished(int i, std::uint16_t* winners) const {
        const auto last_lanes = [&](int k) { return hn::Load(block_, complete_ + 8 * (i + 7 - k)); };
        hn::StoreU(last_lanes_side_by_side(block_, last_lanes), block_, winners);
    }

    void next_block() {}

    void rest(int /*count*/, std::uint16_t* winners) const {
        for (int q = 0; q < stride; ++q) {
            alignas(64) std::uint16_t of_lanes[lanes];
            if (q == stride - 1) {
                hn::Store(state_.candidate[q], Tag(), of_lanes);
            } else {
                const int at = stride - 2 - q;
                Argmin argmin = Argmin::from_lane_below(state_.sum[at], state_.candidate[at]);
                argmin.update(state_.least[q], 0);
                hn::Store(argmin.candidate, Tag(), of_lanes);
            }
            for (int lane = 0; lane < lanes; ++lane) {
                winners[stride * lane + q] = of_lanes[lane];
            }
        }
    }

private:
    hn::FixedTag<std::uint16_t, 8> block_{};
    State state_;
    alignas(64) std::uint16_t complete_[8 * at_once];  // the last block of the running minima, of each pixel
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
