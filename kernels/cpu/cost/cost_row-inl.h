// SPDX-License-Identifier: Apache-2.0
// Where the matching costs of a row go.
#if defined(DISPARITYD_CPU_COST_COST_ROW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_COST_COST_ROW_INL_H_
#undef DISPARITYD_CPU_COST_COST_ROW_INL_H_
#else
#define DISPARITYD_CPU_COST_COST_ROW_INL_H_
#endif

#include <cstddef>

#include "kernels/cpu/match_layout.h"
#include "kernels/cpu/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// Which candidate each lane of a register holds.
template <int registers, int lanes>
struct CandidateOfLane {
    alignas(64) std::uint8_t in[registers][lanes] = {};

    constexpr CandidateOfLane() {
        for (int k = 0; k < registers * lanes; ++k) {
            in[k % registers][k / registers] = static_cast<std::uint8_t>(k);
        }
    }
};
template <int registers, int lanes>
inline constexpr CandidateOfLane<registers, lanes> candidate_of_lane;

/// The least that each candidate of a pixel may cost: nothing, or `padding_cost` and the bias of all costs past the
/// last of `count` candidates.
template <class Tag, int registers>
class LeastCosts {
    using V = hn::Vec<Tag>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));

public:
    LeastCosts(int count, int bias) : padded_(count != registers * lanes) {
        const Tag tag;
        const V last = hn::Set(tag, static_cast<std::uint8_t>(count - 1));
        const V padding = hn::Set(tag, static_cast<std::uint8_t>(bias + padding_cost));
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            const V k = hn::Load(tag, candidate_of_lane<registers, lanes>.in[r]);
            hn::Store(hn::IfThenElse(hn::Eq(hn::Max(k, last), last), hn::Zero(tag), padding), tag, of_[r]);
        }
    }

    bool are_some() const { return padded_; }
    HWY_INLINE V at(int r) const { return hn::Load(Tag(), of_[r]); }

private:
    bool padded_;
    alignas(64) std::uint8_t of_[registers][lanes];
};

/// A row of costs, `registers` vectors for each pixel, and perhaps its copy past the caches.
template <class Tag, int registers>
class CostRow {
    using V = hn::Vec<Tag>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));

public:
    CostRow(std::uint8_t* costs, std::uint8_t* streamed) : costs_(costs), streamed_(streamed) {}

    bool has_copy() const { return streamed_ != nullptr; }

    /// Register r of pixel x.
    std::uint8_t* at(int x, int r) const { return costs_ + offset(x, r); }

    /// `count` registers from pixel x on; with `streaming` to the copy too.
    template <bool streaming>
    HWY_INLINE void store(const V* costs, int count, int x) const {
        const Tag tag;
        std::uint8_t* const out = at(x, 0);
        DISPARITYD_UNROLL
        for (int i = 0; i < count; ++i) {
            hn::Store(costs[i], tag, out + i * lanes);
        }
        if constexpr (streaming) {  // without other stores between the parts of a line
            std::uint8_t* const past_caches = streamed_ + offset(x, 0);
            DISPARITYD_UNROLL
            for (int i = 0; i < count; ++i) {
                hn::Stream(costs[i], tag, past_caches + i * lanes);
            }
        }
    }

    /// The copy of pixels [0, width), from their costs.
    void stream(int width) const {
        const Tag tag;
        for (int x = 0; x < width; ++x) {
            DISPARITYD_UNROLL
            for (int r = 0; r < registers; ++r) {
                hn::Stream(hn::Load(tag, at(x, r)), tag, streamed_ + offset(x, r));
            }
        }
    }

    /// Of register r of pixel x from the row's beginning.
    static std::ptrdiff_t offset(int x, int r) { return (static_cast<std::ptrdiff_t>(x) * registers + r) * lanes; }

private:
    std::uint8_t* costs_;
    std::uint8_t* streamed_;
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
