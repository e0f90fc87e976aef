// SPDX-License-Identifier: Apache-2.0
// Rows of images in the memory of kernels, which work on whole vectors.
#if defined(DISPARITYD_CPU_SIMD_IMAGE_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_SIMD_IMAGE_ROWS_INL_H_
#undef DISPARITYD_CPU_SIMD_IMAGE_ROWS_INL_H_
#else
#define DISPARITYD_CPU_SIMD_IMAGE_ROWS_INL_H_
#endif

#include "kernels/cpu/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// Bytes that loops over whole vectors may read or write past the end of a row.
constexpr int row_slack = 128;

inline int rounded_up(int value, int unit) {
    return (value + unit - 1) / unit * unit;
}

/// `from` backwards: to[0] = from[count - 1].
inline void mirror(const std::uint8_t* from, int count, std::uint8_t* to) {
    const hn::FixedTag<std::uint8_t, 16> block;
    alignas(16) static constexpr std::uint8_t backwards[16] = {15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0};
    const auto order = hn::Load(block, backwards);
    int i = 0;
    for (; i + 16 <= count; i += 16) {
        hn::StoreU(hn::TableLookupBytes(hn::LoadU(block, from + count - 16 - i), order), block, to + i);
    }
    for (; i < count; ++i) {
        to[i] = from[count - 1 - i];
    }
}

/// Which byte of block `source` is byte i of block r of what load_split() gives, for values of `size` bytes; 0x80:
/// none.
template <int registers, int size>
struct SplitPlaces {
    alignas(16) std::uint8_t of[registers][registers][16] = {};

    constexpr SplitPlaces() {
        for (int r = 0; r < registers; ++r) {
            for (int i = 0; i < 16; ++i) {
                const int byte = (registers * (i / size) + r) * size + i % size;
                for (int source = 0; source < registers; ++source) {
                    of[r][source][i] = static_cast<std::uint8_t>(byte / 16 == source ? byte % 16 : 0x80);
                }
            }
        }
    }
};
template <int registers, int size>
inline constexpr SplitPlaces<registers, size> split_places;

/// load_split() for any number of registers, block by block.
template <int registers, class Tag>
HWY_INLINE void load_split_blocks(Tag tag, const hn::TFromD<Tag>* from, hn::Vec<Tag>* out) {
    constexpr int size = sizeof(hn::TFromD<Tag>);
    constexpr std::size_t lanes = hn::MaxLanes(Tag());
    if constexpr (lanes * size > 16) {
        const hn::Half<Tag> half;
        hn::Vec<decltype(half)> lower[registers];
        hn::Vec<decltype(half)> upper[registers];
        load_split_blocks<registers>(half, from, lower);
        load_split_blocks<registers>(half, from + registers * lanes / 2, upper);
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            out[r] = hn::Combine(tag, upper[r], lower[r]);
        }
    } else {
        const hn::FixedTag<std::uint8_t, 16> bytes;
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            auto taken = hn::Zero(bytes);
            DISPARITYD_UNROLL
            for (std::size_t source = 0; source < registers; ++source) {
                const auto block = hn::BitCast(bytes, hn::LoadU(tag, from + source * lanes));
                const auto places = hn::Load(bytes, split_places<registers, size>.of[r][source]);
                taken = hn::Or(taken, hn::TableLookupBytesOr0(block, places));
            }
            out[r] = hn::BitCast(tag, taken);
        }
    }
}

/// Lane i of out[r] is from[registers * i + r].
template <int registers, class Tag>
HWY_INLINE void load_split(Tag tag, const hn::TFromD<Tag>* from, hn::Vec<Tag>* out) {
    if constexpr (registers == 1) {
        out[0] = hn::LoadU(tag, from);
    } else if constexpr (registers == 2) {
        hn::LoadInterleaved2(tag, from, out[0], out[1]);
    } else if constexpr (registers == 3) {
        hn::LoadInterleaved3(tag, from, out[0], out[1], out[2]);
    } else if constexpr (registers == 4) {
        hn::LoadInterleaved4(tag, from, out[0], out[1], out[2], out[3]);
    } else if constexpr (registers % 2 != 0) {
        load_split_blocks<registers>(tag, from, out);
    } else {
        constexpr int half = registers / 2;
        hn::Vec<Tag> first[half];
        hn::Vec<Tag> second[half];
        load_split<half>(tag, from, first);
        load_split<half>(tag, from + half * hn::MaxLanes(tag), second);
        DISPARITYD_UNROLL
        for (int r = 0; r < half; ++r) {
            out[r] = hn::ConcatEven(tag, second[r], first[r]);
            out[half + r] = hn::ConcatOdd(tag, second[r], first[r]);
        }
    }
}

/// from[registers * i + r] to to[r * part + i]; whole vectors are read and written.
template <int registers, class T>
void split(const T* from, int count, T* to, int part) {
    const hn::ScalableTag<T> tag;
    const int lanes = static_cast<int>(hn::Lanes(tag));
    for (int i = 0; registers * i < count; i += lanes) {
        hn::Vec<decltype(tag)> v[registers];
        load_split<registers>(tag, from + registers * i, v);
        DISPARITYD_UNROLL
        for (int r = 0; r < registers; ++r) {
            hn::StoreU(v[r], tag, to + r * part + i);
        }
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
