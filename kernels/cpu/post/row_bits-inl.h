// SPDX-License-Identifier: Apache-2.0
// Rows of disparities as bits: which pixels have one, and which have one like that of the pixel to the left or above.
#if defined(DISPARITYD_CPU_POST_ROW_BITS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_POST_ROW_BITS_INL_H_
#undef DISPARITYD_CPU_POST_ROW_BITS_INL_H_
#else
#define DISPARITYD_CPU_POST_ROW_BITS_INL_H_
#endif

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "hwy/highway.h"
#include "kernels/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// One bit per pixel of a row, the first pixel in the lowest bit of the first word; those beyond the row are 0.
struct RowBits {
    static constexpr int size = max_side / 64;
    std::uint64_t words[size] = {};
};

/// Little-endian, as all of our instruction sets are.
inline std::uint64_t word_of(const std::uint8_t* bytes) {
    std::uint64_t value = 0;
    std::memcpy(&value, bytes, sizeof(value));
    return value;
}

/// A row with a rejected pixel before it and many behind it, so that vectors need no special ends.
class PaddedRow {
public:
    PaddedRow() = default;
    void load(const std::int16_t* row, int width, std::int16_t invalid) {
        pixels_[front - 1] = invalid;
        std::copy_n(row, width, pixels_ + front);
        std::fill_n(pixels_ + front + width, back, invalid);
    }
    void clear(int width, std::int16_t invalid) { std::fill_n(pixels_, front + width + back, invalid); }
    const std::int16_t* pixels() const { return pixels_ + front; }

private:
    static constexpr int front = 32;
    static constexpr int back = 64;
    alignas(64) std::int16_t pixels_[front + max_side + back];
};

/// The masks of 64 pixels; Highway may read and write 8 bytes from each of them on.
constexpr int mask_bytes = 8 + 8;

/// Of 64 pixels, aligned as vectors are: which equal `value`.
HWY_INLINE std::uint64_t equal_bits(const std::int16_t* pixels, std::int16_t value) {
    const hn::ScalableTag<std::int16_t> tag;
    constexpr int lanes = static_cast<int>(hn::MaxLanes(tag));
    alignas(8) std::uint8_t bytes[mask_bytes];
    for (int i = 0; i < 64; i += lanes) {
        hn::StoreMaskBits(tag, hn::Eq(hn::Load(tag, pixels + i), hn::Set(tag, value)), bytes + i / 8);
    }
    return word_of(bytes);
}

/// What regions are made of. Bits of pixels that are rejected are 0.
struct LikenessBits {
    RowBits valid;
    RowBits like_left;
    RowBits like_above;
};

class Likeness {
    using Numbers = hn::ScalableTag<std::int16_t>;
    using Words = hn::RebindToUnsigned<Numbers>;
    using V = hn::Vec<Numbers>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Numbers()));

public:
    /// Disparities are alike when they differ by at most `step`, 0 or more.
    Likeness(std::int16_t invalid, int step)
        : invalid_(hn::Set(Numbers(), invalid)),
          step_(hn::Set(Words(), static_cast<std::uint16_t>(std::min(step, 0xffff)))) {}

    HWY_INLINE void row(const PaddedRow& row, const PaddedRow& above, int width, LikenessBits& bits) const {
        for (int first = 0; first < width; first += 64) {
            alignas(8) std::uint8_t valid[mask_bytes];
            alignas(8) std::uint8_t like_left[mask_bytes];
            alignas(8) std::uint8_t like_above[mask_bytes];
            for (int i = 0; i < 64; i += lanes) {
                const std::int16_t* from = row.pixels() + first + i;
                const V own = hn::Load(Numbers(), from);
                const V left = hn::LoadU(Numbers(), from - 1);
                const V up = hn::Load(Numbers(), above.pixels() + first + i);
                const auto is_valid = hn::Ne(own, invalid_);
                hn::StoreMaskBits(Numbers(), is_valid, valid + i / 8);
                hn::StoreMaskBits(Numbers(), hn::And(is_valid, alike(own, left)), like_left + i / 8);
                hn::StoreMaskBits(Numbers(), hn::And(is_valid, alike(own, up)), like_above + i / 8);
            }
            bits.valid.words[first / 64] = word_of(valid);
            bits.like_left.words[first / 64] = word_of(like_left);
            bits.like_above.words[first / 64] = word_of(like_above);
        }
    }

private:
    // `other` is valid and like `own`.
    HWY_INLINE hn::Mask<Numbers> alike(V own, V other) const {
        const auto apart = hn::BitCast(Words(), hn::Sub(hn::Max(own, other), hn::Min(own, other)));
        const auto near = hn::Eq(hn::Min(apart, step_), apart);
        return hn::And(hn::Ne(other, invalid_), hn::RebindMask(Numbers(), near));
    }
    V invalid_;
    hn::Vec<Words> step_;
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
