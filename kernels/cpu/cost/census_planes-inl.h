// SPDX-License-Identifier: Apache-2.0
// Step 3 of docs/algorithm.md into the form in which costs are computed: planes of bytes, for the same bits of many
// pixels one load, or one plane of whole words. The order of the bits is free, since only differing bits are counted.
#if defined(DISPARITYD_CPU_COST_CENSUS_PLANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_COST_CENSUS_PLANES_INL_H_
#undef DISPARITYD_CPU_COST_CENSUS_PLANES_INL_H_
#else
#define DISPARITYD_CPU_COST_CENSUS_PLANES_INL_H_
#endif

#include <algorithm>
#include <type_traits>

#include "kernels/cpu/cost/census_window-inl.h"
#include "kernels/cpu/cost/census_words-inl.h"
#include "kernels/cpu/cost/gradient-inl.h"
#include "kernels/cpu/match_layout.h"
#include "kernels/cpu/simd/prefetch-inl.h"
#include "kernels/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

// Where the processor counts the bits of bytes, a plane holds 8 bits of a pixel; elsewhere bits are counted by table
// lookup, 4 at a time: those of a left pixel choose one of 16 tables of 16 bytes, and are the upper half of their byte,
// which is then the table's place.
#if HWY_TARGET == HWY_AVX3_DL || HWY_ARCH_ARM
constexpr int bits_per_plane = 8;
constexpr int lowest_left_bit = 0;
#else
constexpr int bits_per_plane = 4;
constexpr int lowest_left_bit = 4;
#endif
template <class Cost>
constexpr int census_planes = (Cost::bits + bits_per_plane - 1) / bits_per_plane;
/// With that of the gradient, which is the last one.
template <class Cost>
constexpr int planes_of = census_planes<Cost> + (Cost::gradient ? 1 : 0);

/// Whether there is one plane, of words: where the processor counts their bits too and a pixel has one register. With
/// more, neighbouring pixels share loads of planes anyway.
template <class Cost>
constexpr bool in_words(int registers) {
    return HWY_TARGET == HWY_AVX3_DL && registers == 1 && !Cost::gradient;
}

/// What a plane has of each pixel.
template <class Cost, int registers>
using CensusUnit = std::conditional_t<in_words<Cost>(registers), std::uint64_t, std::uint8_t>;

template <class Cost>
CensusLayout census_layout(int width, DisparityLayout layout) {
    const bool words = in_words<Cost>(layout.registers);
    const int unit = words ? sizeof(std::uint64_t) : sizeof(std::uint8_t);
    CensusLayout census;
    census.planes = words ? 1 : planes_of<Cost>;
    census.left_pitch = unit * (rounded_up(width, 64) + row_slack);
    census.right_part = unit * (rounded_up((width + layout.candidates()) / layout.registers, 64) + row_slack);
    census.right_pitch = census.right_part * layout.registers;
    return census;
}

/// Positions [first, first + count) of row y of an image into all planes, `pitch` bytes from plane to plane; whole
/// vectors of bytes are written. Bits have the same order in both orders of columns, natural for the left image and
/// mirrored for the right. `next` is asked for.
template <class Cost, class Unit, Order order>
void census_row(const CensusSource<Cost, order>& source, int y, int first, int count, Unit* planes, int pitch,
                Memory next) {
    constexpr bool words = sizeof(Unit) > 1;
    const hn::ScalableTag<std::int8_t> tag;
    const int lanes = static_cast<int>(hn::Lanes(tag));
    constexpr int right = order == Order::natural ? 1 : -1;
    constexpr int lowest_bit = order == Order::natural ? lowest_left_bit : 0;
    const CensusRows rows = source.rows(y, first);
    [[maybe_unused]] const auto margin = hn::Set(tag, static_cast<std::int8_t>(Cost::coarseness));
    Prefetch soon(next, std::max((count + lanes - 1) / lanes, 1));
    for (int x = 0; x < count; x += lanes) {
        soon.portion();
        auto centre = hn::LoadU(tag, rows.centres[1] + x);
        if constexpr (Cost::coarseness > 0) {
            centre = hn::SaturatedSub(centre, margin);
        }
        auto bits = hn::Zero(tag);
        decltype(bits) bytes[words ? census_planes<Cost> : 1];
        std::uint8_t* out = reinterpret_cast<std::uint8_t*>(planes + x);
        int byte = 0;
        int bit = 0;
        const auto take_byte = [&]() HWY_ATTR {
            if constexpr (words) {
                bytes[byte++] = bits;
            } else {
                hn::StoreU(bits, tag, reinterpret_cast<std::int8_t*>(out));
                out += pitch;
            }
        };
        DISPARITYD_UNROLL
        for (int dy = 0; dy <= 2 * Cost::radius_y; ++dy) {
            decltype(bits) beside[2 * census_radius_x + 1];
            load_beside(tag, rows.neighbours[dy] + x, beside);
            DISPARITYD_UNROLL
            for (int dx = -census_radius_x; dx <= census_radius_x; ++dx) {
                if (!Cost::compares(dx, dy - Cost::radius_y)) {
                    continue;
                }
                const auto less = hn::Lt(beside[census_radius_x + right * dx], centre);
                bits = add_where(less, bits, hn::Set(tag, static_cast<std::int8_t>(1 << (lowest_bit + bit))));
                if (++bit == bits_per_plane) {
                    take_byte();
                    bits = hn::Zero(tag);
                    bit = 0;
                }
            }
        }
        take_byte();
        if constexpr (words) {
            store_census_words(bytes, out);
        }
        if constexpr (Cost::gradient) {
            store_gradients<std::max(Cost::coarseness, 1)>(rows.centres + 1, x, right, out);
        }
    }
}

template <class Cost, class Unit>
void census_left(const MatchGeometry& geometry, Plane<const std::uint8_t> image, Plane<const std::uint8_t> smoothed,
                 std::uint8_t* planes, Rows rows) {
    CensusSource<Cost, Order::natural> source(image, smoothed, rows.first);
    const std::size_t row_bytes = geometry.census.left_row();
    for (int y = rows.first; y < rows.last; ++y) {
        source.move_to(y);
        std::uint8_t* out = planes + static_cast<std::size_t>(y) * row_bytes;
        census_row<Cost, Unit>(source, y, 0, geometry.width, reinterpret_cast<Unit*>(out), geometry.census.left_pitch,
                               {out + row_bytes, row_bytes});
    }
}

/// Entry i of a mirrored plane belongs to column width - 1 - d_min - i of the right image: candidate k of left column
/// x is entry width - 1 - x + k. Entries of columns outside the image hold what happens to be there; costs of such
/// candidates are replaced.
template <class Cost, int registers>
void census_right(const MatchGeometry& geometry, Plane<const std::uint8_t> image, Plane<const std::uint8_t> smoothed,
                  std::uint8_t* planes, Rows rows) {
    const CensusLayout& census = geometry.census;
    const int entries = geometry.width + geometry.layout.candidates();
    const int first_entry = std::clamp(-geometry.range.first, 0, entries);  // of the last column inside
    const int first_column = std::max(geometry.range.first, 0);             // mirrored
    const int columns = std::clamp(geometry.width - first_column, 0, entries - first_entry);
    constexpr int max_entries = max_side + max_disparities + row_slack * 4;
    alignas(64) std::uint8_t whole[registers == 1 ? 1 : planes_of<Cost>][registers == 1 ? 1 : max_entries] = {};
    CensusSource<Cost, Order::mirrored> source(image, smoothed, rows.first);
    for (int y = rows.first; y < rows.last; ++y) {
        source.move_to(y);
        std::uint8_t* out = planes + static_cast<std::size_t>(y) * census.right_row();
        const Memory next{out + census.right_row(), census.right_row()};
        if constexpr (registers == 1) {
            using Unit = CensusUnit<Cost, registers>;
            census_row<Cost, Unit>(source, y, first_column, columns, reinterpret_cast<Unit*>(out) + first_entry,
                                   census.right_pitch, next);
        } else {
            census_row<Cost, std::uint8_t>(source, y, first_column, columns, whole[0] + first_entry, max_entries, next);
            for (int i = 0; i < planes_of<Cost>; ++i) {
                split<registers>(whole[i], entries, out + i * census.right_pitch, census.right_part);
            }
        }
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
