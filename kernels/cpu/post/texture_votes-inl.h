// SPDX-License-Identifier: Apache-2.0
// For step 10 of docs/algorithm.md: which pixels of a row vouch for their region, and which speak against it.
#if defined(DISPARITYD_CPU_POST_TEXTURE_VOTES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_POST_TEXTURE_VOTES_INL_H_
#undef DISPARITYD_CPU_POST_TEXTURE_VOTES_INL_H_
#else
#define DISPARITYD_CPU_POST_TEXTURE_VOTES_INL_H_
#endif

#include <algorithm>
#include <bit>
#include <cstdint>

#include "kernels/cpu/post/row_bits-inl.h"
#include "kernels/cpu/simd/lanes-inl.h"
#include "kernels/texture.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// The sums 1, 2, 1 down each column of the three rows around one, with the border replicated on every side.
class ColumnSums {
    using Sums = hn::ScalableTag<std::int16_t>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Sums()));

public:
    void load(Plane<const std::uint8_t> image, int y) {
        const hn::Rebind<std::uint8_t, Sums> bytes;
        const std::uint8_t* above = image.row(std::max(y - 1, 0));
        const std::uint8_t* row = image.row(y);
        const std::uint8_t* below = image.row(std::min(y + 1, image.height - 1));
        const auto wide = [&](const std::uint8_t* at) HWY_ATTR { return hn::PromoteTo(Sums(), hn::LoadU(bytes, at)); };
        int x = 0;
        for (; x + lanes <= image.width; x += lanes) {
            const auto middle = wide(row + x);
            const auto outer = hn::Add(wide(above + x), wide(below + x));
            hn::Store(hn::Add(outer, hn::Add(middle, middle)), Sums(), sums_ + front + x);
        }
        for (; x < image.width; ++x) {
            sums_[front + x] = static_cast<std::int16_t>(above[x] + 2 * row[x] + below[x]);
        }
        std::fill_n(sums_, front, sums_[front]);
        std::fill_n(sums_ + front + image.width, back, sums_[front + image.width - 1]);
    }

    /// Readable from 32 before the row to 128 behind it.
    const std::int16_t* at(int x) const { return sums_ + front + x; }

private:
    static constexpr int front = 32;
    static constexpr int back = 128;
    alignas(64) std::int16_t sums_[front + max_side + back];
};

class TextureVotes {
    using Numbers = hn::ScalableTag<std::int32_t>;
    using Halves = hn::Rebind<std::int16_t, Numbers>;
    using V = hn::Vec<Numbers>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Numbers()));

public:
    TextureVotes(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right) : left_(left), right_(right) {}

    /// Finds the votes of row y; `disparity` holds its pixels.
    void find(int y, const PaddedRow& disparity, std::int16_t invalid) {
        sums_.load(right_, y);
        set_right_gradients();
        sums_.load(left_, y);
        for (int first = 0; first < left_.width; first += 64) {
            std::uint64_t confirmed = 0;
            std::uint64_t refuted = 0;
            for (int i = 0; i < 64; i += lanes) {
                add_votes(first + i, disparity.pixels() + first + i, invalid, i, confirmed, refuted);
            }
            confirmed_.words[first / 64] = confirmed;
            refuted_.words[first / 64] = refuted;
        }
    }

    /// The sum of the votes of [begin, end), which is not empty.
    int between(int begin, int end) const {
        const int last = (end - 1) / 64;
        std::uint64_t mask = ~std::uint64_t{0} << (begin % 64);
        int votes = 0;
        for (int w = begin / 64; w < last; ++w) {
            votes += in_word(w, mask);
            mask = ~std::uint64_t{0};
        }
        return votes + in_word(last, mask & ~std::uint64_t{0} >> (63 - (end - 1) % 64));
    }

private:
    int in_word(int word, std::uint64_t mask) const {
        return std::popcount(confirmed_.words[word] & mask) - std::popcount(refuted_.words[word] & mask);
    }

    // What stands `reach` to the right, less what stands as far to the left.
    static HWY_INLINE V difference(const std::int16_t* at, int reach) {
        const auto apart = hn::Sub(hn::LoadU(Halves(), at + reach), hn::LoadU(Halves(), at - reach));
        return hn::PromoteTo(Numbers(), apart);
    }

    static HWY_INLINE std::uint64_t bits_of(hn::Mask<Numbers> mask) {
        alignas(8) std::uint8_t bytes[mask_bytes] = {};
        hn::StoreMaskBits(Numbers(), mask, bytes);
        return word_of(bytes) & ((std::uint64_t{1} << lanes) - 1);
    }

    // A gather takes longer than all else here: one finds a pixel's gradient and that of the next, which fit 16 bits
    // each.
    void set_right_gradients() {
        const Numbers tag;
        std::int32_t* pairs = right_gradients_ + 1;
        for (int x = 0; x < right_.width; x += lanes) {
            const V own = hn::And(difference(sums_.at(x), 1), hn::Set(tag, 0xffff));
            hn::StoreU(hn::Or(own, hn::ShiftLeft<16>(difference(sums_.at(x + 1), 1))), tag, pairs + x);
        }
        const auto twice = [](std::int32_t pair) {
            const auto own = static_cast<std::uint32_t>(pair) & 0xffff;
            return static_cast<std::int32_t>(own << 16 | own);
        };
        pairs[-1] = twice(pairs[0]);
        pairs[right_.width - 1] = twice(pairs[right_.width - 1]);
    }

    // Of x and of x + 1, of the last pixel beyond the image's sides: the first in the lower half.
    HWY_INLINE V right_gradients(V x) const {
        const Numbers tag;
        const V inside = hn::Min(hn::Max(x, hn::Set(tag, -1)), hn::Set(tag, right_.width - 1));
        return hn::GatherIndex(tag, right_gradients_ + 1, inside);
    }

    HWY_INLINE void add_votes(int x, const std::int16_t* disparity, std::int16_t invalid, int bit,
                              std::uint64_t& confirmed, std::uint64_t& refuted) const {
        const Numbers tag;
        const V gradient = difference(sums_.at(x), 1);
        const V ramp = difference(sums_.at(x), texture_reach);
        const V steep = hn::Abs(gradient);
        const V bend = hn::Abs(hn::Sub(hn::Mul(gradient, hn::Set(tag, texture_reach)), ramp));
        const V d16 = hn::PromoteTo(tag, hn::LoadU(Halves(), disparity));
        const auto textured = hn::And(hn::Ne(d16, hn::Set(tag, std::int32_t{invalid})),
                                      hn::And(hn::Gt(steep, hn::Set(tag, texture_gradient - 1)),
                                              hn::Gt(bend, hn::Set(tag, texture_reach * texture_gradient - 1))));
        const std::uint64_t with_texture = bits_of(textured);
        if (with_texture == 0) {
            return;
        }
        const V whole = hn::ShiftRight<4>(hn::Add(d16, hn::Set(tag, 15)));
        const V match = hn::Sub(numbers_from(tag, x), whole);
        const V pair = right_gradients(match);
        const V other = hn::ShiftRight<16>(hn::ShiftLeft<16>(pair));
        const V next = hn::ShiftRight<16>(pair);
        const V between = hn::Min(hn::Max(gradient, hn::Min(other, next)), hn::Max(other, next));
        const V apart = hn::Abs(hn::Sub(gradient, between));
        const std::uint64_t refuting = bits_of(hn::Gt(hn::Add(apart, apart), steep));
        confirmed |= (with_texture & ~refuting) << bit;
        refuted |= (with_texture & refuting) << bit;
    }

    Plane<const std::uint8_t> left_;
    Plane<const std::uint8_t> right_;
    ColumnSums sums_;
    alignas(64) std::int32_t right_gradients_[1 + max_side + 64];  // from the pixel left of the image on
    RowBits confirmed_;
    RowBits refuted_;
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
