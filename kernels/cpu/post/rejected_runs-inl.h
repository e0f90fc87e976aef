// SPDX-License-Identifier: Apache-2.0
// For step 10 of docs/algorithm.md: rejecting parts of a row.
#if defined(DISPARITYD_CPU_POST_REJECTED_RUNS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_POST_REJECTED_RUNS_INL_H_
#undef DISPARITYD_CPU_POST_REJECTED_RUNS_INL_H_
#else
#define DISPARITYD_CPU_POST_REJECTED_RUNS_INL_H_
#endif

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "kernels/cpu/post/row_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// Runs of a row, rejected without a branch for each: where they begin and end a bit is flipped, and all between two
/// flips is set in one go.
class RejectedRuns {
    using Numbers = hn::ScalableTag<std::int16_t>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Numbers()));

public:
    void add_if(bool rejected, int begin, int end) {
        const auto bit = static_cast<std::uint64_t>(rejected);
        flips_[begin / 64] ^= bit << (begin % 64);
        flips_[end / 64] ^= bit << (end % 64);
    }

    /// Writes `invalid` where they are, and forgets them.
    void write(std::int16_t* pixels, int width, std::int16_t invalid) {
        std::uint64_t inside = 0;  // all bits, when a run goes on from the word before
        for (int first = 0; first < width; first += 64) {
            const std::uint64_t rejected = inside ^ odd_flips_up_to(flips_[first / 64]);
            inside = rejected >> 63 != 0 ? ~std::uint64_t{0} : 0;
            flips_[first / 64] = 0;
            if (rejected != 0) {
                write(pixels + first, std::min(width - first, 64), rejected, invalid);
            }
        }
        flips_[width / 64] = 0;
    }

private:
    static std::uint64_t odd_flips_up_to(std::uint64_t flips) {
        for (int shift = 1; shift < 64; shift *= 2) {
            flips ^= flips << shift;
        }
        return flips;
    }

    static void write(std::int16_t* pixels, int count, std::uint64_t rejected, std::int16_t invalid) {
        std::uint8_t bits[mask_bytes] = {};
        std::memcpy(bits, &rejected, sizeof(rejected));
        int x = 0;
        for (; x + lanes <= count; x += lanes) {
            const auto mask = hn::LoadMaskBits(Numbers(), bits + x / 8);
            const auto found = hn::LoadU(Numbers(), pixels + x);
            hn::StoreU(hn::IfThenElse(mask, hn::Set(Numbers(), invalid), found), Numbers(), pixels + x);
        }
        for (; x < count; ++x) {
            pixels[x] = (rejected >> x & 1) != 0 ? invalid : pixels[x];
        }
    }

    std::uint64_t flips_[RowBits::size + 1] = {};
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
