// SPDX-License-Identifier: Apache-2.0
// Step 1 of docs/algorithm.md in colour, from YUYV: each source pixel becomes BGR, then every channel is interpolated.
#if defined(DISPARITYD_CPU_RECTIFY_RECTIFY_COLOUR_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_RECTIFY_RECTIFY_COLOUR_INL_H_
#undef DISPARITYD_CPU_RECTIFY_RECTIFY_COLOUR_INL_H_
#else
#define DISPARITYD_CPU_RECTIFY_RECTIFY_COLOUR_INL_H_
#endif

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "hwy/highway.h"
#include "kernels/cpu/simd/lanes-inl.h"
#include "kernels/matcher.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// Where pixels of a rectified row come from, and the source pixels around each of these places.
class ColourSources {
public:
    static constexpr int at_once = 64;

    ColourSources(const RawImage& raw, Eye eye) : source_(raw.eye(eye)), width_(raw.eye_width), height_(raw.height) {}

    /// As find_mapped(), for a row that is a part of the source.
    void find_region(int x, int y, int count) {
        for (int i = 0; i < count; ++i) {
            find(i, x + i, y);
            fraction[i] = 0;
        }
    }
    /// `count` pixels, at most `at_once`, from their entries of a map.
    void find_mapped(const std::int16_t* xy, const std::uint16_t* fractions, int count) {
        for (int i = 0; i < count; ++i) {
            find(i, xy[2 * i], xy[2 * i + 1]);
            fraction[i] = fractions[i];
        }
    }

    // Of each of the four around the place: the pair of pixels Y0 U Y1 V that it is one of, lowest byte first. Where
    // the left ones are the first or the second of their pairs, the right ones are the other.
    alignas(64) std::uint32_t pairs[4][at_once] = {};
    alignas(64) std::uint32_t left_is_second[at_once] = {};
    alignas(64) std::uint32_t fraction[at_once] = {};

private:
    static constexpr std::uint32_t black = 0x80008000;  // what is outside adds nothing to any channel

    void find(int i, int x, int y) {
        left_is_second[i] = static_cast<std::uint32_t>(x) & 1;
        if (x >= 0 && x + 1 < width_ && y >= 0 && y + 1 < height_) {
            const std::uint8_t* left = source_.row(y) + 4 * (x / 2);
            const std::uint8_t* right = source_.row(y) + 4 * ((x + 1) / 2);
            std::memcpy(&pairs[0][i], left, 4);
            std::memcpy(&pairs[1][i], right, 4);
            std::memcpy(&pairs[2][i], left + source_.stride, 4);
            std::memcpy(&pairs[3][i], right + source_.stride, 4);
            return;
        }
        for (int k = 0; k < 4; ++k) {
            const int pixel_x = x + k % 2;
            const int pixel_y = y + k / 2;
            pairs[k][i] = black;
            if (pixel_x >= 0 && pixel_x < width_ && pixel_y >= 0 && pixel_y < height_) {
                std::memcpy(&pairs[k][i], source_.row(pixel_y) + 4 * (pixel_x / 2), 4);
            }
        }
    }

    Plane<const std::uint8_t> source_;
    int width_;
    int height_;
};

/// A few pixels in colour.
class ColourPixels {
    using Numbers = hn::ScalableTag<std::int32_t>;
    using Words = hn::RebindToUnsigned<Numbers>;
    using V = hn::Vec<Numbers>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Numbers()));

    struct Bgr {
        V b, g, r;
    };

public:
    void write(const ColourSources& sources, int count, std::uint8_t* bgr) {
        for (int i = 0; i < count; i += lanes) {
            interpolate(sources, i);
        }
        const hn::FixedTag<std::uint8_t, 16> block;
        int i = 0;
        for (; i + 16 <= count; i += 16) {
            hn::StoreInterleaved3(hn::Load(block, b_ + i), hn::Load(block, g_ + i), hn::Load(block, r_ + i), block,
                                  bgr + 3 * i);
        }
        for (; i < count; ++i) {
            bgr[3 * i] = b_[i];
            bgr[3 * i + 1] = g_[i];
            bgr[3 * i + 2] = r_[i];
        }
    }

private:
    static HWY_INLINE V number(int value) { return hn::Set(Numbers(), value); }

    HWY_INLINE void interpolate(const ColourSources& sources, int i) {
        const V fraction = hn::BitCast(Numbers(), hn::Load(Words(), sources.fraction + i));
        const V fx = hn::And(fraction, number(31));
        const V fy = hn::And(hn::ShiftRight<5>(fraction), number(31));
        const auto second = hn::Eq(hn::Load(Words(), sources.left_is_second + i), hn::Set(Words(), 1U));
        Bgr sum{number(512), number(512), number(512)};
        DISPARITYD_UNROLL
        for (int k = 0; k < 4; ++k) {
            const auto pair = hn::Load(Words(), sources.pairs[k] + i);
            const auto from_second = hn::ShiftRight<16>(pair);
            const auto luma =
                k % 2 == 0 ? hn::IfThenElse(second, from_second, pair) : hn::IfThenElse(second, pair, from_second);
            const V weight_x = k % 2 == 0 ? hn::Sub(number(32), fx) : fx;
            const V weight_y = k / 2 == 0 ? hn::Sub(number(32), fy) : fy;
            const V weight = hn::Mul(weight_x, weight_y);
            const Bgr pixel = from_yuv(byte(luma), byte(hn::ShiftRight<8>(pair)), byte(hn::ShiftRight<24>(pair)));
            sum.b = hn::Add(sum.b, hn::Mul(weight, pixel.b));
            sum.g = hn::Add(sum.g, hn::Mul(weight, pixel.g));
            sum.r = hn::Add(sum.r, hn::Mul(weight, pixel.r));
        }
        store(sum.b, b_ + i);
        store(sum.g, g_ + i);
        store(sum.r, r_ + i);
    }

    static HWY_INLINE V byte(hn::Vec<Words> v) { return hn::BitCast(Numbers(), hn::And(v, hn::Set(Words(), 255U))); }
    static HWY_INLINE void store(V sum, std::uint8_t* to) {
        const hn::Rebind<std::uint8_t, Numbers> bytes;
        hn::StoreU(hn::DemoteTo(bytes, hn::ShiftRight<10>(sum)), bytes, to);
    }

    // ITU-R BT.601, studio range, 20 fraction bits.
    static HWY_INLINE Bgr from_yuv(V y, V u, V v) {
        const V luma = hn::Add(hn::Mul(hn::Max(hn::Sub(y, number(16)), number(0)), number(1220542)), number(1 << 19));
        u = hn::Sub(u, number(128));
        v = hn::Sub(v, number(128));
        const auto channel = [luma](V chroma) {
            const V level = hn::ShiftRight<20>(hn::Add(luma, chroma));
            return hn::Min(hn::Max(level, number(0)), number(255));
        };
        const V of_green = hn::Add(hn::Mul(u, number(-409993)), hn::Mul(v, number(-852492)));
        return {channel(hn::Mul(u, number(2116026))), channel(of_green), channel(hn::Mul(v, number(1673527)))};
    }

    alignas(64) std::uint8_t b_[ColourSources::at_once];
    alignas(64) std::uint8_t g_[ColourSources::at_once];
    alignas(64) std::uint8_t r_[ColourSources::at_once];
};

inline void rectify_yuyv_colour(const RawImage& raw, Eye eye, const Rectifier& rectifier, Plane<std::uint8_t> bgr,
                                Rows rows) {
    ColourSources sources(raw, eye);
    const RectifyMap& map = eye == Eye::left ? rectifier.left : rectifier.right;
    ColourPixels pixels;
    const int width = bgr.width / 3;
    for (int y = rows.first; y < rows.last; ++y) {
        for (int x = 0; x < width; x += ColourSources::at_once) {
            const int count = std::min(ColourSources::at_once, width - x);
            if (rectifier.mapped) {
                sources.find_mapped(map.xy.row(y) + 2 * x, map.fraction.row(y) + x, count);
            } else {
                sources.find_region(rectifier.crop_x + x, rectifier.crop_y + y, count);
            }
            pixels.write(sources, count, bgr.row(y) + 3 * x);
        }
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
