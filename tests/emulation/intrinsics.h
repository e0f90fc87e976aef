// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

/// CUDA's integer and packed intrinsics that kernels/cuda uses, as "CUDA Math API" specifies them.

inline int __popcll(unsigned long long value) {
    return __builtin_popcountll(value);
}

inline int __popc(unsigned value) {
    return __builtin_popcount(value);
}

/// The zeros above the highest bit that is set; 32 where there is none.
inline int __clz(int value) {
    return value == 0 ? 32 : __builtin_clz(static_cast<unsigned>(value));
}

/// The position of the lowest bit that is set, counted from 1; 0 where there is none.
inline int __ffs(int value) {
    return __builtin_ffs(value);
}

/// |x - y| of each of the four bytes.
inline unsigned __vabsdiffu4(unsigned x, unsigned y) {
    unsigned result = 0;
    for (int shift = 0; shift < 32; shift += 8) {
        const unsigned a = x >> shift & 0xff;
        const unsigned b = y >> shift & 0xff;
        result |= (a > b ? a - b : b - a) << shift;
    }
    return result;
}

/// |x - y| + z
inline unsigned __usad(unsigned x, unsigned y, unsigned z) {
    return (x > y ? x - y : y - x) + z;
}

/// Four bytes chosen from the eight of x (0 to 3) and y (4 to 7) by the low three bits of the selector's nibbles.
inline unsigned __byte_perm(unsigned x, unsigned y, unsigned selector) {
    const std::uint64_t bytes = std::uint64_t{y} << 32 | x;
    unsigned result = 0;
    for (unsigned i = 0; i < 4; ++i) {
        const unsigned chosen = selector >> (4 * i) & 7;
        result |= static_cast<unsigned>(bytes >> (8 * chosen) & 0xff) << (8 * i);
    }
    return result;
}

namespace disparityd::simt {

template <typename Operation>
unsigned for_both_halves(Operation operation) {
    return (operation(0) & 0xffffU) | (operation(16) & 0xffffU) << 16;
}

inline unsigned half(unsigned pair, int shift) {
    return pair >> shift & 0xffffU;
}

/// PTX's min.f16x2 without .NaN: f16 in each half, -0 before +0, of a NaN and a number the number, of two NaNs 0x7fff.
inline unsigned min_f16x2(unsigned a, unsigned b) {
    const auto is_nan = [](unsigned f16) { return (f16 & 0x7fffU) > 0x7c00U; };
    const auto rank = [](unsigned f16) { return (f16 & 0x8000U) != 0 ? ~f16 & 0xffffU : f16 | 0x8000U; };
    return for_both_halves([=](int s) {
        const unsigned x = half(a, s);
        const unsigned y = half(b, s);
        if (is_nan(x)) {
            return is_nan(y) ? 0x7fffU : y;
        }
        return is_nan(y) || rank(x) < rank(y) ? x : y;
    });
}

}  // namespace disparityd::simt

/// The unsigned minimum of each half.
inline unsigned __vminu2(unsigned a, unsigned b) {
    using namespace disparityd::simt;
    return for_both_halves([=](int s) { return std::min(half(a, s), half(b, s)); });
}

/// min(a + b, c) of each half, unsigned; the sum wraps.
inline unsigned __viaddmin_u16x2(unsigned a, unsigned b, unsigned c) {
    using namespace disparityd::simt;
    return for_both_halves([=](int s) { return std::min((half(a, s) + half(b, s)) & 0xffffU, half(c, s)); });
}
