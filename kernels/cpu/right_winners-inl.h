// SPDX-License-Identifier: Apache-2.0
// Winners of the right image. A right pixel meets one candidate of each left pixel, the next one at the next pixel: the
// least key of a part is carried from class to class, what leads after a part waits until the next part is met.
#if defined(DISPARITYD_CPU_RIGHT_WINNERS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_RIGHT_WINNERS_INL_H_
#undef DISPARITYD_CPU_RIGHT_WINNERS_INL_H_
#else
#define DISPARITYD_CPU_RIGHT_WINNERS_INL_H_
#endif

#include <algorithm>

#include "kernels/cpu/leader-inl.h"
#include "kernels/cpu/least_of_pixels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// Keys of a part at one more pixel: returns the least ones of what is met as a whole with them. `least` has those of
/// what is not, by the class met last.
template <int part_classes, class V>
HWY_INLINE V least_met(const V* keys, V* least) {
    const V whole = hn::Min(keys[part_classes - 1], least[part_classes - 2]);
    DISPARITYD_UNROLL
    for (int q = part_classes - 2; q > 0; --q) {
        least[q] = hn::Min(keys[q], least[q - 1]);
    }
    least[0] = keys[0];
    return whole;
}

/// For any number of parts: what leads waits in memory.
template <class Tag, int classes, int at_once>
class RightWinnersInMemory {
    using V = hn::Vec<Tag>;
    using Leads = Leader<Tag, classes>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    static constexpr int part_classes = classes_of_part<classes>;
    static constexpr int parts = classes / part_classes;

public:
    /// What stays in registers for a block: least keys of parts that are not met as a whole yet, by the class met last.
    struct State {
        // Written out: GCC compiles an implicit one for the baseline.
        State() {}

        V least[parts][part_classes - 1];
    };

    RightWinnersInMemory() {
        for (auto& of_part : waiting_) {
            for (int i = 0; i < part_classes; ++i) {
                hn::Store(hn::Set(Tag(), Leads::no_sum), Tag(), of_part[i].sums);
                hn::Store(hn::Set(Tag(), Leads::no_candidate), Tag(), of_part[i].candidates);
            }
        }
        DISPARITYD_UNROLL
        for (auto& of_part : state_.least) {
            std::fill_n(of_part, part_classes - 1, hn::Set(Tag(), no_key));
        }
    }

    State state() const { return state_; }

    /// What the block's pixels have made of it: in line, since what other functions may see does not stay in registers.
    HWY_INLINE void keep(const State& state) { state_ = state; }

    /// Keys of the i-th pixel of a block.
    HWY_INLINE void add(const V* keys, int i, State& state) {
        DISPARITYD_UNROLL
        for (int part = 0; part < parts; ++part) {
            Leads leader = before(part, i);
            leader.meet(least_met<part_classes>(keys + part * part_classes, state.least[part]), part);
            Waiting& waits = waiting_[part][i + part_classes];
            hn::Store(leader.sum, Tag(), waits.sums);
            hn::Store(leader.candidate, Tag(), waits.candidates);
        }
    }

    /// The winners of the right pixels whose candidates are complete with the i-th pixel (which meets them at the last
    /// candidate) and the seven pixels after it, in reverse.
    HWY_INLINE void finished(int i, std::uint16_t* winners) const {
        const hn::FixedTag<std::uint16_t, 8> block;
        const Waiting* waits = waiting_[parts - 1] + part_classes + i;
        const auto last_lanes = [&](int k) { return hn::Load(block, waits[7 - k].candidates + lanes - 8); };
        hn::StoreU(last_lanes_side_by_side(block, last_lanes), block, winners);
    }

    /// After a whole block.
    void next_block() {
        for (auto& of_part : waiting_) {
            DISPARITYD_UNROLL
            for (int i = 0; i < part_classes; ++i) {
                const Waiting& last = of_part[at_once + i];
                hn::Store(hn::Load(Tag(), last.sums), Tag(), of_part[i].sums);
                hn::Store(hn::Load(Tag(), last.candidates), Tag(), of_part[i].candidates);
            }
        }
    }

    /// After the last block, of `count` pixels: the winners of right pixels on the way. Entry k was met at candidate k
    /// by the last pixel.
    void rest(int count, std::uint16_t* winners) const {
        for (int part = 0; part < parts; ++part) {
            for (int q = 0; q < part_classes; ++q) {
                alignas(64) std::uint16_t of_lanes[lanes];
                if (q == part_classes - 1) {
                    std::copy_n(waiting_[part][count - 1 + part_classes].candidates, lanes, of_lanes);
                } else {
                    Leads leader = before(part, count - 1 + (part_classes - 1 - q));
                    leader.meet(state_.least[part][q], part);
                    hn::Store(leader.candidate, Tag(), of_lanes);
                }
                for (int lane = 0; lane < lanes; ++lane) {
                    winners[classes * lane + part * part_classes + q] = of_lanes[lane];
                }
            }
        }
    }

private:
    // What leads in each lane after a part, for the pixel that meets the next part.
    struct Waiting {
        alignas(2 * lanes) std::uint16_t sums[lanes];
        alignas(2 * lanes) std::uint16_t candidates[lanes];
    };

    // What leads before a part that is complete with the i-th pixel. Candidates of a lane follow those of the lane
    // before it; not by a load that is moved by a lane, since that would wait until the stores before it have left the
    // core.
    HWY_INLINE Leads before(int part, int i) const {
        const Waiting& waits = waiting_[(part + parts - 1) % parts][i];
        const V sum = hn::Load(Tag(), waits.sums);
        const V candidate = hn::Load(Tag(), waits.candidates);
        if (part > 0) {
            return {sum, candidate};
        }
        return Leads::from_lane_below(sum, candidate);
    }

    State state_;
    Waiting waiting_[parts][at_once + part_classes];
};

/// For one part, and many registers: what leads waits in them. Of a pixel a block is stored, instead of two vectors
/// that are stored and loaded again.
template <class Tag, int classes, int at_once>
class RightWinnersInRegisters {
    using V = hn::Vec<Tag>;
    using Leads = Leader<Tag, classes>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));
    static_assert(classes_of_part<classes> == classes);

public:
    /// What stays in registers for a block.
    struct State {
        State() {}  // written out as above

        V least[classes - 1];  ///< keys of what is not met as a whole yet, by the class met last
        // What leads, for the pixel that comes as many later.
        V sum[classes];
        V candidate[classes];
    };

    RightWinnersInRegisters() {
        DISPARITYD_UNROLL
        for (int q = 0; q < classes; ++q) {
            state_.sum[q] = hn::Set(Tag(), Leads::no_sum);
            state_.candidate[q] = hn::Set(Tag(), Leads::no_candidate);
        }
        std::fill_n(state_.least, classes - 1, hn::Set(Tag(), no_key));
    }

    State state() const { return state_; }
    HWY_INLINE void keep(const State& state) { state_ = state; }

    HWY_INLINE void add(const V* keys, int i, State& state) {
        Leads leader = Leads::from_lane_below(state.sum[0], state.candidate[0]);
        leader.meet(least_met<classes>(keys, state.least), 0);
        DISPARITYD_UNROLL
        for (int q = 0; q + 1 < classes; ++q) {
            state.sum[q] = state.sum[q + 1];
            state.candidate[q] = state.candidate[q + 1];
        }
        state.sum[classes - 1] = leader.sum;
        state.candidate[classes - 1] = leader.candidate;
        hn::Store(last_block(Tag(), leader.candidate), block_, complete_ + 8 * i);
    }

    HWY_INLINE void finished(int i, std::uint16_t* winners) const {
        const auto last_lanes = [&](int k) { return hn::Load(block_, complete_ + 8 * (i + 7 - k)); };
        hn::StoreU(last_lanes_side_by_side(block_, last_lanes), block_, winners);
    }

    void next_block() {}

    void rest(int /*count*/, std::uint16_t* winners) const {
        for (int q = 0; q < classes; ++q) {
            alignas(64) std::uint16_t of_lanes[lanes];
            if (q == classes - 1) {
                hn::Store(state_.candidate[q], Tag(), of_lanes);
            } else {
                const int at = classes - 2 - q;
                Leads leader = Leads::from_lane_below(state_.sum[at], state_.candidate[at]);
                leader.meet(state_.least[q], 0);
                hn::Store(leader.candidate, Tag(), of_lanes);
            }
            for (int lane = 0; lane < lanes; ++lane) {
                winners[classes * lane + q] = of_lanes[lane];
            }
        }
    }

private:
    hn::FixedTag<std::uint16_t, 8> block_{};
    State state_;
    alignas(64) std::uint16_t complete_[8 * at_once];  // the last block of what leads, of each pixel
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
