// SPDX-License-Identifier: Apache-2.0
// Looking up pairs of neighbours in the luma of a few rows of a source picture: neighbouring pixels of a rectified
// image come from neighbouring places, so that a few loads and byte shuffles do instead of a load for each.
#if defined(DISPARITYD_CPU_RECTIFY_SOURCE_WINDOW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_RECTIFY_SOURCE_WINDOW_INL_H_
#undef DISPARITYD_CPU_RECTIFY_SOURCE_WINDOW_INL_H_
#else
#define DISPARITYD_CPU_RECTIFY_SOURCE_WINDOW_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include "kernels/cpu/simd/wide_tables-inl.h"
#include "kernels/raw_image.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Windows of luma, one for each block of eight lanes of `Words`.
template <class Words, PixelFormat format>
class BlockWindows {
    using V = hn::Vec<Words>;
    using Bytes = hn::Repartition<std::uint8_t, Words>;
    using Block = hn::FixedTag<std::uint8_t, 16>;

public:
    static constexpr int lanes_of_window = 8;
    static constexpr int width = 16;
    static constexpr int rows = 3;
    static constexpr int windows = static_cast<int>(hn::MaxLanes(Words())) / lanes_of_window;

    /// One address per window: its first pixel.
    BlockWindows(const std::uint8_t* const* first_pixels, std::ptrdiff_t stride)
        : first_pixels_(first_pixels), stride_(stride) {}

    /// In the lanes of each window its value.
    static HWY_INLINE V spread(const std::uint16_t* values) {
        if constexpr (windows == 1) {
            return hn::Set(Words(), values[0]);
        } else {
            const hn::Half<Words> half;
            return hn::Combine(Words(), hn::Set(half, values[1]), hn::Set(half, values[0]));
        }
    }
    /// What find() takes for pixel x of a window and its right neighbour, 0 <= x < width - 1.
    static HWY_INLINE V index(V x) {
        return hn::Add(hn::Or(x, hn::ShiftLeft<8>(x)), hn::Set(Words(), std::uint16_t{0x100}));
    }
    /// p(x) + 256 p(x + 1) of a row.
    HWY_INLINE V find(int row, V index) const {
        return hn::BitCast(Words(), hn::TableLookupBytes(table(row), hn::BitCast(Bytes(), index)));
    }

private:
    HWY_INLINE hn::Vec<Bytes> table(int row) const {
        if constexpr (windows == 1) {
            return block(row, 0);
        } else {
            static_assert(windows == 2);
            return hn::Combine(Bytes(), block(row, 1), block(row, 0));
        }
    }
    HWY_INLINE hn::Vec<Block> block(int row, int window) const {
        const std::uint8_t* pixels = first_pixels_[window] + row * stride_;
        if constexpr (format == PixelFormat::yuyv) {
            return hn::ConcatEven(Block(), hn::LoadU(Block(), pixels + width), hn::LoadU(Block(), pixels));
        } else {
            return hn::LoadU(Block(), pixels);
        }
    }

    const std::uint8_t* const* first_pixels_;
    std::ptrdiff_t stride_;
};

#if HWY_TARGET == HWY_AVX3_DL
/// One window for all lanes: byte shuffles reach through whole registers, and through two of them.
template <class Words, PixelFormat format>
class WholeWindow {
    using V = hn::Vec<Words>;
    using Bytes = hn::Repartition<std::uint8_t, Words>;
    static_assert(hn::MaxLanes(Words()) == 32);

public:
    static constexpr int lanes_of_window = 32;
    static constexpr int width = 64;
    static constexpr int rows = 6;
    static constexpr int windows = 1;

    WholeWindow(const std::uint8_t* const* first_pixels, std::ptrdiff_t stride)
        : first_pixel_(first_pixels[0]), stride_(stride) {}

    static HWY_INLINE V spread(const std::uint16_t* values) { return hn::Set(Words(), values[0]); }
    static HWY_INLINE V index(V x) {
        const V both = hn::Add(hn::Or(x, hn::ShiftLeft<8>(x)), hn::Set(Words(), std::uint16_t{0x100}));
        return format == PixelFormat::yuyv ? hn::Add(both, both) : both;
    }
    HWY_INLINE V find(int row, V index) const {
        const std::uint8_t* pixels = first_pixel_ + row * stride_;
        const auto table = hn::LoadU(Bytes(), pixels);
        if constexpr (format == PixelFormat::yuyv) {
            const auto upper = hn::LoadU(Bytes(), pixels + 64);
            return hn::BitCast(Words(), look_up(table, upper, hn::BitCast(Bytes(), index)));
        } else {
            return hn::BitCast(Words(), look_up(table, hn::BitCast(Bytes(), index)));
        }
    }

private:
    const std::uint8_t* first_pixel_;
    std::ptrdiff_t stride_;
};
#endif

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
