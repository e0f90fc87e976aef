// SPDX-License-Identifier: Apache-2.0
// For step 11 of docs/algorithm.md: the nearest disparity that is not rejected, straight up and to both sides of it,
// for all pixels of a row; carried from row to row, so that no pixel has to search. The same downwards.
#if defined(DISPARITYD_CPU_POST_NEAREST_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_POST_NEAREST_ROWS_INL_H_
#undef DISPARITYD_CPU_POST_NEAREST_ROWS_INL_H_
#else
#define DISPARITYD_CPU_POST_NEAREST_ROWS_INL_H_
#endif

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Of each pixel: in the direction (-1, 1), (0, 1) or (1, 1), with rows counted away from it; a disparity of its own is
/// the nearest. The invalid disparity where there is none.
struct NearestRow {
    std::int16_t* sides[3];
};

/// Memory for such rows.
class NearestRows {
public:
    static constexpr int margin = 32;  // a vector at most

    static std::size_t bytes(int width, int rows) {
        return static_cast<std::size_t>(rows) * 3 * static_cast<std::size_t>(stride(width)) * sizeof(std::int16_t);
    }
    NearestRows(std::byte* memory, int width)
        : memory_(reinterpret_cast<std::int16_t*>(memory)), stride_(stride(width)) {}

    NearestRow row(int i) const {
        std::int16_t* first = memory_ + 3 * i * stride_ + margin;
        return {{first, first + stride_, first + 2 * stride_}};
    }
    void clear(int i, std::int16_t invalid) const { std::fill_n(memory_ + 3 * i * stride_, 3 * stride_, invalid); }

private:
    static std::ptrdiff_t stride(int width) { return margin + (width + margin - 1) / margin * margin + margin; }

    std::int16_t* memory_;
    std::ptrdiff_t stride_;
};

/// Carries `previous`, of the row that the pass comes from, on to `row`. `pixels`: disparities of the row.
inline void carry(const std::int16_t* pixels, int width, std::int16_t invalid_value, const NearestRow& previous,
                  const NearestRow& row) {
    const hn::ScalableTag<std::int16_t> tag;
    constexpr int lanes = static_cast<int>(hn::MaxLanes(tag));
    const auto invalid = hn::Set(tag, invalid_value);
    alignas(64) std::int16_t last[lanes];
    int x = 0;
    for (; x < width; x += lanes) {
        const std::int16_t* from = pixels + x;
        if (x + lanes > width) {
            std::fill_n(last, lanes, invalid_value);
            std::copy_n(from, width - x, last);
            from = last;
        }
        const auto own = hn::LoadU(tag, from);
        const auto rejected = hn::Eq(own, invalid);
        for (int side = 0; side < 3; ++side) {
            const auto carried = hn::LoadU(tag, previous.sides[side] + x + side - 1);
            hn::StoreU(hn::IfThenElse(rejected, carried, own), tag, row.sides[side] + x);
        }
    }
    // Beside the image nothing comes in.
    for (std::int16_t* side : row.sides) {
        side[-1] = invalid_value;
        side[x] = invalid_value;
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
