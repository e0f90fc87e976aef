// SPDX-License-Identifier: Apache-2.0
// Step 3 of docs/algorithm.md into planes of bytes, the form in which costs are computed: for the same bits of many
// pixels one load. The order of the bits is free, since only differing bits are counted.
#if defined(DISPARITYD_CPU_CENSUS_PLANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_CENSUS_PLANES_INL_H_
#undef DISPARITYD_CPU_CENSUS_PLANES_INL_H_
#else
#define DISPARITYD_CPU_CENSUS_PLANES_INL_H_
#endif

#include <algorithm>
#include <cstring>

#include "kernels/cpu/lanes-inl.h"
#include "kernels/cpu/prefetch-inl.h"
#include "kernels/cpu/sgm_kernels.h"
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
constexpr int census_bits = 62;
constexpr int census_planes = (census_bits + bits_per_plane - 1) / bits_per_plane;
constexpr int census_radius_x = 4;
constexpr int census_radius_y = 3;

/// Bytes that loops over whole vectors may read or write past the end of a row.
constexpr int row_slack = 128;

inline int rounded_up(int value, int unit) {
    return (value + unit - 1) / unit * unit;
}

inline CensusLayout census_layout(int width, DisparityLayout layout) {
    CensusLayout census;
    census.planes = census_planes;
    census.left_pitch = rounded_up(width, 64) + row_slack;
    census.right_part = rounded_up((width + layout.candidates()) / layout.registers, 64) + row_slack;
    census.right_pitch = census.right_part * layout.registers;
    return census;
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

enum class Order : std::uint8_t {
    natural,
    mirrored,  ///< the last column of the image comes first
};

/// The seven rows around the row in work, with their borders replicated, as signed bytes (the order stays, and signed
/// comparison is an instruction everywhere).
template <Order order>
class CensusWindow {
public:
    CensusWindow(Plane<const std::uint8_t> image, int first) : image_(image) {
        for (int y = first - census_radius_y; y < first + census_radius_y; ++y) {
            load(y);
        }
    }

    /// To be called for y = first, first + 1, ..
    void move_to(int y) { load(y + census_radius_y); }

    const std::uint8_t* row(int y) const { return &rows_[(y + rows) % rows][row_slack]; }

private:
    static constexpr int rows = 8;  // a ring, a power of two

    void load(int y) {
        const hn::ScalableTag<std::uint8_t> tag;
        const int lanes = static_cast<int>(hn::Lanes(tag));
        const int width = image_.width;
        const std::uint8_t* in = image_.row(std::clamp(y, 0, image_.height - 1));
        std::uint8_t* out = &rows_[(y + rows) % rows][row_slack];
        if constexpr (order == Order::mirrored) {
            mirror(in, width, out);
        } else {
            std::copy_n(in, width, out);
        }
        std::fill_n(out - census_radius_x, census_radius_x, out[0]);
        const auto last = hn::Set(tag, out[width - 1]);
        for (int x = width; x < width + row_slack; x += lanes) {
            hn::StoreU(last, tag, out + x);
        }
        const auto sign = hn::Set(tag, 0x80);
        for (int x = -lanes; x < width + census_radius_x; x += lanes) {
            hn::StoreU(hn::Xor(hn::LoadU(tag, out + x), sign), tag, out + x);
        }
    }

    Plane<const std::uint8_t> image_;
    alignas(64) std::uint8_t rows_[rows][max_side + 2 * row_slack] = {};
};

/// What is at from - census_radius_x .. from + census_radius_x. Where no more is loaded for it, some of it without
/// loads, which would all but one cross cache lines.
template <class Tag, class V = hn::Vec<Tag>>
HWY_INLINE void load_beside(Tag tag, const std::int8_t* from, V* beside) {
    static_assert(census_radius_x == 4);
    constexpr bool between = bytes_to_next == census_radius_x;
    V* middle = beside + census_radius_x;
    DISPARITYD_UNROLL
    for (int dx = -census_radius_x; dx <= census_radius_x; ++dx) {
        if (!between || dx <= 0 || dx == census_radius_x) {
            middle[dx] = in_register(hn::LoadU(tag, from + dx));
        }
    }
    if constexpr (between) {
        middle[1] = bytes_between<1>(middle[0], middle[4]);
        middle[2] = bytes_between<2>(middle[0], middle[4]);
        middle[3] = bytes_between<3>(middle[0], middle[4]);
    }
}

/// Positions [first, first + count) of row y of a window into all planes, `pitch` bytes from plane to plane; whole
/// vectors are written. Bits have the same order in both orders of columns, natural for the left image and mirrored for
/// the right. `next` is asked for.
template <Order order>
void census_row(const CensusWindow<order>& window, int y, int first, int count, std::uint8_t* planes, int pitch,
                Memory next) {
    const hn::ScalableTag<std::int8_t> tag;
    const int lanes = static_cast<int>(hn::Lanes(tag));
    constexpr int right = order == Order::natural ? 1 : -1;
    constexpr int lowest_bit = order == Order::natural ? lowest_left_bit : 0;
    const std::int8_t* rows[2 * census_radius_y + 1];
    for (int dy = -census_radius_y; dy <= census_radius_y; ++dy) {
        rows[dy + census_radius_y] = reinterpret_cast<const std::int8_t*>(window.row(y + dy) + first);
    }
    Prefetch soon(next, std::max((count + lanes - 1) / lanes, 1));
    for (int x = 0; x < count; x += lanes) {
        soon.portion();
        const auto centre = hn::LoadU(tag, rows[census_radius_y] + x);
        auto bits = hn::Zero(tag);
        std::uint8_t* out = planes + x;
        int bit = 0;
        DISPARITYD_UNROLL
        for (int dy = 0; dy <= 2 * census_radius_y; ++dy) {
            decltype(bits) beside[2 * census_radius_x + 1];
            load_beside(tag, rows[dy] + x, beside);
            DISPARITYD_UNROLL
            for (int dx = -census_radius_x; dx <= census_radius_x; ++dx) {
                if (dy == census_radius_y && dx == 0) {
                    continue;
                }
                const auto less = hn::Lt(beside[census_radius_x + right * dx], centre);
                bits = add_where(less, bits, hn::Set(tag, static_cast<std::int8_t>(1 << (lowest_bit + bit))));
                if (++bit == bits_per_plane) {
                    hn::StoreU(bits, tag, reinterpret_cast<std::int8_t*>(out));
                    out += pitch;
                    bits = hn::Zero(tag);
                    bit = 0;
                }
            }
        }
        hn::StoreU(bits, tag, reinterpret_cast<std::int8_t*>(out));
    }
}

inline void census_left(const SgmGeometry& geometry, Plane<const std::uint8_t> image, std::uint8_t* planes, Rows rows) {
    CensusWindow<Order::natural> window(image, rows.first);
    const std::size_t row_bytes = geometry.census.left_row();
    for (int y = rows.first; y < rows.last; ++y) {
        window.move_to(y);
        std::uint8_t* out = planes + static_cast<std::size_t>(y) * row_bytes;
        census_row(window, y, 0, geometry.width, out, geometry.census.left_pitch, {out + row_bytes, row_bytes});
    }
}

/// Lane i of out[r] is from[registers * i + r]. `registers` is 1, 2, 3 or 4 times a power of two.
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

/// Entry i of a mirrored plane belongs to column width - 1 - d_min - i of the right image: candidate k of left column
/// x is entry width - 1 - x + k. Entries of columns outside the image hold what happens to be there; costs of such
/// candidates are replaced.
template <int registers>
void census_right(const SgmGeometry& geometry, Plane<const std::uint8_t> image, std::uint8_t* planes, Rows rows) {
    const CensusLayout& census = geometry.census;
    const int entries = geometry.width + geometry.layout.candidates();
    const int first_entry = std::clamp(-geometry.range.first, 0, entries);  // of the last column inside
    const int first_column = std::max(geometry.range.first, 0);             // mirrored
    const int columns = std::clamp(geometry.width - first_column, 0, entries - first_entry);
    constexpr int longest = max_side + max_disparities + row_slack * 4;
    alignas(64) std::uint8_t whole[registers == 1 ? 1 : census_planes][longest] = {};
    CensusWindow<Order::mirrored> window(image, rows.first);
    for (int y = rows.first; y < rows.last; ++y) {
        window.move_to(y);
        std::uint8_t* out = planes + static_cast<std::size_t>(y) * census.right_row();
        const Memory next{out + census.right_row(), census.right_row()};
        if constexpr (registers == 1) {
            census_row(window, y, first_column, columns, out + first_entry, census.right_pitch, next);
        } else {
            census_row(window, y, first_column, columns, whole[0] + first_entry, longest, next);
            for (int i = 0; i < census_planes; ++i) {
                split<registers>(whole[i], entries, out + i * census.right_pitch, census.right_part);
            }
        }
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
