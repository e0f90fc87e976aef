// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <cstdint>

#include <cuda_runtime.h>
#include <gtest/gtest.h>

#include "kernels/cuda/packed.h"
#include "tests/kernels/support.h"

namespace disparityd::test {
namespace {

// Random words among which those with special halves and bytes are frequent.
unsigned any_word(Random& random) {
    constexpr std::array<unsigned, 8> halves = {0, 1, 0x7f, 0x80, 0x7fff, 0x8000, 0xff00, 0xffff};
    const auto half = [&] {
        return pick(random, 0, 1) == 0 ? halves[random() % halves.size()] : static_cast<unsigned>(random() & 0xffff);
    };
    const unsigned low = half();
    return low | half() << 16;
}

TEST(Intrinsics, CountBits) {
    Random random(1);
    for (int round = 0; round < 1000; ++round) {
        const std::uint64_t word = std::uint64_t{any_word(random)} << 32 | any_word(random);
        int bits = 0;
        for (int i = 0; i < 64; ++i) {
            bits += static_cast<int>(word >> i & 1);
        }
        ASSERT_EQ(__popcll(word), bits);
    }
    EXPECT_EQ(__popcll(~0ULL), 64);
    EXPECT_EQ(__popc(0x80000001U), 2);
    EXPECT_EQ(__popc(~0U), 32);
}

TEST(Intrinsics, FindTheFirstAndTheLastBit) {
    EXPECT_EQ(__clz(0), 32);
    EXPECT_EQ(__ffs(0), 0);
    for (int i = 0; i < 32; ++i) {
        const auto bit = static_cast<int>(1U << i);
        EXPECT_EQ(__clz(bit), 31 - i);
        EXPECT_EQ(__ffs(bit), i + 1);
    }
    EXPECT_EQ(__clz(0x00300100), 10);
    EXPECT_EQ(__ffs(0x00300100), 9);
}

TEST(Intrinsics, AbsoluteDifferenceIsAddedModulo32Bits) {
    EXPECT_EQ(__usad(3, 10, 5), 12U);
    EXPECT_EQ(__usad(10, 3, 5), 12U);
    EXPECT_EQ(__usad(0, 0xffffffff, 2), 1U);
    EXPECT_EQ(__usad(0x80000000, 0x7fffffff, 0), 1U);
}

TEST(Intrinsics, AbsoluteDifferencesOfBytesAreTakenApart) {
    EXPECT_EQ(__vabsdiffu4(0x00ff017f, 0xff000280), 0xffff0101U);
    EXPECT_EQ(__vabsdiffu4(0xff000280, 0x00ff017f), 0xffff0101U);
}

TEST(Intrinsics, PermutationTakesAnyByteOfTwoWords) {
    Random random(2);
    for (int round = 0; round < 1000; ++round) {
        const unsigned x = any_word(random);
        const unsigned y = any_word(random);
        const unsigned selector = any_word(random);
        const unsigned result = __byte_perm(x, y, selector);
        for (unsigned i = 0; i < 4; ++i) {
            const unsigned chosen = selector / (1U << (4 * i)) % 8;  // the nibble's fourth bit means nothing
            const unsigned byte = chosen < 4 ? x / (1U << (8 * chosen)) : y / (1U << (8 * (chosen - 4)));
            ASSERT_EQ(result >> (8 * i) & 0xff, byte & 0xff);
        }
    }
    EXPECT_EQ(__byte_perm(0x33221100, 0x77665544, 0x0246), 0x00224466U);
}

TEST(Intrinsics, HalvesAreComparedApart) {
    Random random(3);
    for (int round = 0; round < 1000; ++round) {
        const unsigned a = any_word(random);
        const unsigned b = any_word(random);
        const unsigned c = any_word(random);
        for (const int shift : {0, 16}) {
            const auto half = [shift](unsigned word) { return static_cast<std::uint16_t>(word >> shift); };
            const auto sum = static_cast<std::uint16_t>(half(a) + half(b));
            ASSERT_EQ(half(__vminu2(a, b)), std::min(half(a), half(b)));
            ASSERT_EQ(half(__viaddmin_u16x2(a, b, c)), std::min(sum, half(c)));
        }
    }
    EXPECT_EQ(__viaddmin_u16x2(0x0001ffff, 0x00010001, 0xffffffff), 0x00020000U) << "the sum of a half wraps";
}

double value_of_f16(unsigned bits) {
    const int exponent = static_cast<int>(bits >> 10 & 31);
    const int fraction = static_cast<int>(bits & 0x3ff);
    const double magnitude = exponent == 0    ? std::ldexp(fraction, -24)
                             : exponent == 31 ? (fraction == 0 ? INFINITY : NAN)
                                              : std::ldexp(1024 + fraction, exponent - 25);
    return (bits & 0x8000) != 0 ? -magnitude : magnitude;
}

TEST(Intrinsics, MinimumOfF16FollowsItsSpecification) {
    const auto expected = [](unsigned x, unsigned y) {
        const double a = value_of_f16(x);
        const double b = value_of_f16(y);
        if (std::isnan(a) || std::isnan(b)) {
            return std::isnan(a) ? (std::isnan(b) ? 0x7fffU : y) : x;
        }
        return a == b ? x | y : a < b ? x : y;  // of two zeros the negative one
    };
    constexpr std::array<unsigned, 16> halves = {0,      1,      0x03ff, 0x0400, 0x3c00, 0x7bff, 0x7c00, 0x7c01,
                                                 0x8000, 0x8001, 0x83ff, 0xbc00, 0xfbff, 0xfc00, 0xfe00, 0x7fff};
    for (const unsigned x : halves) {
        for (const unsigned y : halves) {
            ASSERT_EQ(simt::min_f16x2(x | y << 16, y | x << 16), expected(x, y) | expected(y, x) << 16)
                << std::hex << x << ' ' << y;
        }
    }
}

TEST(Packed, AveragesAreRoundedUpInEachHalf) {
    for (unsigned a = 0; a < 64; ++a) {
        for (unsigned b = 0; b < 64; ++b) {
            const unsigned low = (a + b + 1) / 2;
            const unsigned high = (63 - a + b + 1) / 2;
            ASSERT_EQ(cuda::average_u16x2(a | (63 - a) << 16, b | b << 16), low | high << 16) << a << ' ' << b;
        }
    }
    EXPECT_EQ(cuda::average_u16x2(0x3fff3fff, 0x3fff3ffe), 0x3fff3fffU);
}

// Why Orin may take the minimum of f16 where integers are meant.
TEST(Packed, HalfPrecisionOrdersSmallIntegersAsTheyAre) {
    for (unsigned bits = 0; bits + 1 < 0x7c00; ++bits) {
        ASSERT_LT(value_of_f16(bits), value_of_f16(bits + 1)) << bits;
        ASSERT_EQ(cuda::min_u16x2_as_f16(bits | (bits + 1) << 16, (bits + 1) | bits << 16), bits * 0x10001);
    }
    // Idle candidates with a penalty, and the largest cost there is.
    EXPECT_LT((cuda::unreachable | 0xff) + 193 + 7 * 255, 0x7c00U);
    EXPECT_GT(cuda::unreachable, 63U * 255U);
}

}  // namespace
}  // namespace disparityd::test
