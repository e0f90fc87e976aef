// SPDX-License-Identifier: Apache-2.0
// Step 1 of docs/algorithm.md for luma: rows of a rectified image straight from the captured picture.
#if defined(DISPARITYD_CPU_RECTIFY_RECTIFY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_RECTIFY_RECTIFY_INL_H_
#undef DISPARITYD_CPU_RECTIFY_RECTIFY_INL_H_
#else
#define DISPARITYD_CPU_RECTIFY_RECTIFY_INL_H_
#endif

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "hwy/cache_control.h"
#include "hwy/highway.h"
#include "kernels/cpu/rectify/source_window-inl.h"
#include "kernels/matcher.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// For each lane ((32-fx)(32-fy) p00 + fx (32-fy) p10 + (32-fx) fy p01 + fx fy p11 + 512) >> 10, where `upper` is
/// p00 + 256 p10, `lower` is p01 + 256 p11 and `fraction` is fy * 32 + fx.
///
/// It fits words: with u and l the sums along x (at most 32 * 255) the numerator is 32 (u + 16) + fy (l - u). The
/// first part is a multiple of 32, so floor(numerator / 32) = u + 16 + floor(fy (l - u) / 32), and the last term is
/// the upper half of the product of 1024 fy and 2 (l - u).
template <class Words, class V = hn::Vec<Words>>
HWY_INLINE V bilinear(Words words, V upper, V lower, V fraction) {
    const hn::RebindToSigned<Words> numbers;
    const V fx = hn::And(fraction, hn::Set(words, std::uint16_t{31}));
    const V fy_1024 = hn::ShiftLeft<5>(hn::And(fraction, hn::Set(words, std::uint16_t{31 * 32})));
    const auto along_x = [&](V pair) {
        const V first = hn::And(pair, hn::Set(words, std::uint16_t{255}));
        return hn::Add(hn::ShiftLeft<5>(first), hn::Mul(fx, hn::Sub(hn::ShiftRight<8>(pair), first)));
    };
    const V u = along_x(upper);
    const V slope = hn::Sub(along_x(lower), u);
    const auto part = hn::MulHigh(hn::BitCast(numbers, fy_1024), hn::BitCast(numbers, hn::Add(slope, slope)));
    return hn::ShiftRight<5>(hn::Add(hn::Add(u, hn::Set(words, std::uint16_t{16})), hn::BitCast(words, part)));
}

/// Rectified rows of one eye from a map, for the formats whose luma lies in every byte or in every other one.
template <PixelFormat format>
class MappedRows {
    static constexpr int pixel_bytes = bytes_per_pixel(format);
#if HWY_TARGET == HWY_AVX3_DL
    using Words = hn::ScalableTag<std::uint16_t>;
    using Windows = WholeWindow<Words, format>;
#else
    using Words = hn::CappedTag<std::uint16_t, 16>;
    using Windows = BlockWindows<Words, format>;
#endif
    using V = hn::Vec<Words>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Words()));

    /// Where each lane's pixel comes from.
    struct Places {
        V x, y;
    };
    /// p(x, y) + 256 p(x + 1, y) of the source pixels around each lane's place, and the same one row below.
    struct Pairs {
        V upper, lower;
    };

public:
    MappedRows(const RawImage& raw, Eye eye, const RectifyMap& map)
        : source_(raw.eye(eye)),
          width_(raw.eye_width),
          map_(map),
          // Differences of coordinates do not wrap round in pictures that maps can reach all of.
          windows_fit_(width_ >= Windows::width && width_ <= 0x7fff && source_.height >= Windows::rows &&
                       source_.height <= 0x7fff) {}

    void row(int y, int width, std::uint8_t* out) const {
        const std::int16_t* xy = map_.xy.row(y);
        const std::uint16_t* fraction = map_.fraction.row(y);
        int x = 0;
        for (; x + lanes <= width; x += lanes) {
            pixels(xy + 2 * x, fraction + x, out + x);
        }
        if (x < width) {
            last_pixels(xy + 2 * x, fraction + x, width - x, out + x);
        }
    }

private:
    HWY_INLINE void pixels(const std::int16_t* xy, const std::uint16_t* fraction, std::uint8_t* out) const {
        const hn::RebindToSigned<Words> numbers;
        const hn::Rebind<std::uint8_t, Words> bytes;
        const V first = hn::LoadU(Words(), reinterpret_cast<const std::uint16_t*>(xy));
        const V second = hn::LoadU(Words(), reinterpret_cast<const std::uint16_t*>(xy) + lanes);
        const Places places{hn::ConcatEven(Words(), second, first), hn::ConcatOdd(Words(), second, first)};
        Pairs pairs{hn::Zero(Words()), hn::Zero(Words())};
        if (!windows_fit_ || !from_windows(xy, places, pairs)) {
            pairs = all_inside(places) ? one_by_one_inside(xy) : one_by_one(xy);
        }
        const V luma = bilinear(Words(), pairs.upper, pairs.lower, hn::LoadU(Words(), fraction));
        hn::StoreU(hn::DemoteTo(bytes, hn::BitCast(numbers, luma)), bytes, out);
    }

    // Less than a vector at the end of a row.
    void last_pixels(const std::int16_t* xy, const std::uint16_t* fraction, int count, std::uint8_t* out) const {
        std::int16_t all_xy[2 * lanes];
        std::uint16_t all_fraction[lanes];
        std::uint8_t all_out[lanes];
        for (int i = 0; i < lanes; ++i) {
            const int from = std::min(i, count - 1);
            std::copy_n(xy + 2 * from, 2, all_xy + 2 * i);
            all_fraction[i] = fraction[from];
        }
        pixels(all_xy, all_fraction, all_out);
        std::copy_n(all_out, count, out);
    }

    /// False when sources lie too far apart, or outside the picture.
    HWY_INLINE bool from_windows(const std::int16_t* xy, const Places& places, Pairs& pairs) const {
        const std::uint8_t* first_pixels[Windows::windows];
        std::uint16_t left[Windows::windows];
        std::uint16_t top[Windows::windows];
        for (int i = 0; i < Windows::windows; ++i) {
            // Maps are smooth: the least coordinates are nearly always at one of the ends.
            const std::int16_t* first = xy + 2 * Windows::lanes_of_window * i;
            const std::int16_t* last = first + 2 * (Windows::lanes_of_window - 1);
            const int x = std::clamp<int>(std::min(first[0], last[0]), 0, width_ - Windows::width);
            const int y = std::clamp<int>(std::min(first[1], last[1]), 0, source_.height - Windows::rows);
            first_pixels[i] = pixel(x, y);
            left[i] = static_cast<std::uint16_t>(x);
            top[i] = static_cast<std::uint16_t>(y);
        }
        // A captured frame comes from memory, in more streams than processors foresee.
        constexpr int rows_ahead = 8;
        hwy::Prefetch(pixel(left[0], std::min(top[0] + rows_ahead, source_.height - 1)));
        const V x = hn::Sub(places.x, Windows::spread(left));
        V y = hn::Sub(places.y, Windows::spread(top));
        if (!all_at_most(x, Windows::width - 2, y, Windows::rows - 2)) {
            return false;
        }
        const Windows windows(first_pixels, source_.stride);
        const V index = Windows::index(x);
        V above = windows.find(1, index);
        pairs = {windows.find(0, index), above};
        for (int row = 1; row < Windows::rows - 1; ++row) {
            const auto in_row_or_below = hn::Ne(hn::Zero(Words()), y);
            if (row > 1 && hn::AllFalse(Words(), in_row_or_below)) {
                break;
            }
            const V below = windows.find(row + 1, index);
            pairs.upper = hn::IfThenElse(in_row_or_below, above, pairs.upper);
            pairs.lower = hn::IfThenElse(in_row_or_below, below, pairs.lower);
            above = below;
            y = hn::SaturatedSub(y, hn::Set(Words(), std::uint16_t{1}));
        }
        return true;
    }

    static HWY_INLINE bool all_at_most(V x, int max_x, V y, int max_y) {
        const V beyond = hn::Or(hn::SaturatedSub(x, hn::Set(Words(), static_cast<std::uint16_t>(max_x))),
                                hn::SaturatedSub(y, hn::Set(Words(), static_cast<std::uint16_t>(max_y))));
        return hn::AllTrue(Words(), hn::Eq(beyond, hn::Zero(Words())));
    }

    const std::uint8_t* pixel(int x, int y) const {
        return source_.row(y) + static_cast<std::ptrdiff_t>(x) * pixel_bytes;
    }

    /// Whether all four pixels around each place are inside the picture.
    HWY_INLINE bool all_inside(const Places& places) const {
        return windows_fit_ && all_at_most(places.x, width_ - 2, places.y, source_.height - 2);
    }

    Pairs one_by_one_inside(const std::int16_t* xy) const {
        // Of YUYV with the chroma between the two.
        alignas(64) std::uint16_t upper[pixel_bytes * lanes];
        alignas(64) std::uint16_t lower[pixel_bytes * lanes];
        for (int i = 0; i < lanes; ++i) {
            const std::uint8_t* first = pixel(xy[2 * i], xy[2 * i + 1]);
            std::memcpy(upper + pixel_bytes * i, first, 2 * pixel_bytes);
            std::memcpy(lower + pixel_bytes * i, first + source_.stride, 2 * pixel_bytes);
        }
        return {loaded_pairs(upper), loaded_pairs(lower)};
    }

    static HWY_INLINE V loaded_pairs(const std::uint16_t* loaded) {
        const V first = hn::Load(Words(), loaded);
        if constexpr (pixel_bytes == 1) {
            return first;
        } else {
            const V second = hn::Load(Words(), loaded + lanes);
            const V left = hn::And(hn::ConcatEven(Words(), second, first), hn::Set(Words(), std::uint16_t{255}));
            return hn::Or(left, hn::ShiftLeft<8>(hn::ConcatOdd(Words(), second, first)));
        }
    }

    Pairs one_by_one(const std::int16_t* xy) const {
        alignas(64) std::uint16_t upper[lanes];
        alignas(64) std::uint16_t lower[lanes];
        for (int i = 0; i < lanes; ++i) {
            upper[i] = pair(xy[2 * i], xy[2 * i + 1]);
            lower[i] = pair(xy[2 * i], xy[2 * i + 1] + 1);
        }
        return {hn::Load(Words(), upper), hn::Load(Words(), lower)};
    }

    // What lies outside counts as 0.
    std::uint16_t pair(int x, int y) const {
        if (y < 0 || y >= source_.height) {
            return 0;
        }
        const std::uint8_t* row = source_.row(y);
        const int first = x >= 0 && x < width_ ? row[x * pixel_bytes] : 0;
        const int second = x + 1 >= 0 && x + 1 < width_ ? row[(x + 1) * pixel_bytes] : 0;
        return static_cast<std::uint16_t>(first | second << 8);
    }

    Plane<const std::uint8_t> source_;
    int width_;
    RectifyMap map_;
    bool windows_fit_;
};

/// Every other byte, or a copy.
template <PixelFormat format>
void copy_luma(const std::uint8_t* in, int width, std::uint8_t* out) {
    if constexpr (format == PixelFormat::grey8) {
        std::copy_n(in, width, out);
    } else {
        const hn::ScalableTag<std::uint8_t> bytes;
        constexpr int lanes = static_cast<int>(hn::MaxLanes(bytes));
        int x = 0;
        for (; x + lanes <= width; x += lanes) {
            const auto first = hn::LoadU(bytes, in + 2 * x);
            hn::StoreU(hn::ConcatEven(bytes, hn::LoadU(bytes, in + 2 * x + lanes), first), bytes, out + x);
        }
        for (; x < width; ++x) {
            out[x] = in[2 * x];
        }
    }
}

template <PixelFormat format>
void rectify_from(const RawImage& raw, Eye eye, const Rectifier& rectifier, Plane<std::uint8_t> out, Rows rows) {
    if (rectifier.mapped) {
        const MappedRows<format> mapped(raw, eye, eye == Eye::left ? rectifier.left : rectifier.right);
        for (int y = rows.first; y < rows.last; ++y) {
            mapped.row(y, out.width, out.row(y));
        }
        return;
    }
    const Plane<const std::uint8_t> source = raw.eye(eye);
    const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(rectifier.crop_x) * bytes_per_pixel(format);
    for (int y = rows.first; y < rows.last; ++y) {
        copy_luma<format>(source.row(rectifier.crop_y + y) + first, out.width, out.row(y));
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
