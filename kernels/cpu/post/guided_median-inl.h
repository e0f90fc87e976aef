// SPDX-License-Identifier: Apache-2.0
// Step 12 of docs/algorithm.md: median of those samples whose intensity is like the pixel's. It is found bit by bit,
// the highest one first: of the samples that agree with the bits found so far, those with the next bit set are counted.
#if defined(DISPARITYD_CPU_POST_GUIDED_MEDIAN_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_POST_GUIDED_MEDIAN_INL_H_
#undef DISPARITYD_CPU_POST_GUIDED_MEDIAN_INL_H_
#else
#define DISPARITYD_CPU_POST_GUIDED_MEDIAN_INL_H_
#endif

#include <algorithm>
#include <bit>
#include <cstdint>

#include "kernels/cpu/post/bit_planes-inl.h"
#include "kernels/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// The columns that are worked on at a time: their planes stay in the first-level cache, and fit any thread's stack.
constexpr int guided_median_columns = std::max(128, 4 * static_cast<int>(hn::MaxLanes(PlaneTag())));

/// A part of an image: eight bands of rows, of which one row each is worked on at a time. A byte has a bit for each.
struct GuidedBlock {
    static constexpr int bands = 8;
    int first_column;
    int columns;
    Rows rows;

    int rows_of_band() const { return (rows.last - rows.first + bands - 1) / bands; }
    int row(int band, int step) const { return rows.first + band * rows_of_band() + step; }
};

/// The disparities of some rows.
struct GuidedValues {
    int least;
    int greatest;

    bool any() const { return least <= greatest; }
    int bits() const { return std::bit_width(static_cast<unsigned>(greatest - least)); }
};

/// Of `rows` as far as they lie in the image.
inline GuidedValues values_between(Plane<const std::int16_t> disparity, std::int16_t invalid_value, Rows rows,
                                   int first_column, int last_column) {
    const hn::ScalableTag<std::int16_t> tag;
    constexpr int lanes = static_cast<int>(hn::MaxLanes(tag));
    const auto invalid = hn::Set(tag, invalid_value);
    const int columns = last_column - first_column;
    alignas(64) std::int16_t narrow[lanes];
    std::fill_n(narrow, lanes, invalid_value);
    auto least = hn::Set(tag, std::int16_t{0x7fff});
    auto greatest = hn::Not(least);
    for (int y = std::max(rows.first, 0); y < std::min(rows.last, disparity.height); ++y) {
        const std::int16_t* row = disparity.row(y) + first_column;
        if (columns < lanes) {
            row = std::copy_n(row, columns, narrow) - columns;
        }
        for (int x = 0; x < columns; x += lanes) {
            const auto value = hn::LoadU(tag, row + std::max(0, std::min(x, columns - lanes)));
            const auto rejected = hn::Eq(value, invalid);
            least = hn::Min(least, hn::IfThenElse(rejected, least, value));
            greatest = hn::Max(greatest, hn::IfThenElse(rejected, greatest, value));
        }
    }
    return {hn::GetLane(hn::MinOfLanes(tag, least)), hn::GetLane(hn::MaxOfLanes(tag, greatest))};
}

/// Disparities as planes of bits, which pixels have one, and intensities, of the rows around those in work; the borders
/// of the image are replicated.
template <int radius>
class GuidedSamples {
public:
    GuidedSamples(Plane<const std::int16_t> disparity, Plane<const std::uint8_t> guide, std::int16_t invalid,
                  const GuidedBlock& block)
        : disparity_(disparity), guide_(guide), invalid_(invalid), block_(block) {
        for (int band = 0; band < GuidedBlock::bands && block.row(band, 0) < block.rows.last; ++band) {
            const int last = std::min(block.row(band + 1, 0), block.rows.last);
            const GuidedValues values =
                values_between(disparity, invalid, {block.row(band, 0) - radius, last + radius},
                               std::max(block.first_column - radius, 0),
                               std::min(block.first_column + block.columns + radius, disparity.width));
            if (values.any()) {
                least_[band] = static_cast<std::int16_t>(values.least);
                bits_ = std::max(bits_, values.bits());
            }
        }
        for (int step = -radius; any() && step < radius; ++step) {
            load(step);
        }
    }

    /// Whether any pixel has a disparity.
    bool any() const { return bits_ >= 0; }
    /// Of what a disparity is more than the least one of its band.
    int bits() const { return bits_; }
    std::int16_t least(int band) const { return least_[band]; }

    /// To be called for step = 0, 1, ..
    void move_to(int step) { load(step + radius); }

    /// Of the first column.
    const std::uint8_t* plane(int step, int bit) const { return &planes_[slot(step)][bit][margin]; }
    const std::uint8_t* measured(int step) const { return &measured_[slot(step)][margin]; }
    const std::uint8_t* intensities(int step, int band) const { return &intensities_[slot(step)][band][margin]; }

private:
    static constexpr int margin = 64;
    static constexpr int stride = margin + guided_median_columns + 2 * margin;
    static constexpr int ring = 8;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(PlaneTag()));

    static int slot(int step) { return (step + ring) % ring; }

    int whole_registers() const { return (block_.columns + lanes - 1) / lanes * lanes; }

    // The columns and `radius` more on both sides, which whole registers of them may end at.
    template <class T>
    void copy_columns(Plane<const T> from, int y, T* to) const {
        const int first = block_.first_column;
        const int begin = std::max(first - radius, 0);
        const int end = std::min(first + block_.columns + radius, from.width);
        const T* row = from.row(std::clamp(y, 0, from.height - 1));
        std::copy(row + begin, row + end, to + (begin - first));
        std::fill(to - radius, to + (begin - first), row[0]);
        std::fill(to + (end - first), to + whole_registers() + radius, row[from.width - 1]);
    }

    void load(int step) {
        for (int band = 0; band < GuidedBlock::bands; ++band) {
            const int y = block_.row(band, step);
            copy_columns(disparity_, y, &values_[band][margin]);
            copy_columns(guide_, y, &intensities_[slot(step)][band][margin]);
        }
        for (int x = margin - radius; x < margin + whole_registers() + radius; x += lanes) {
            make_planes(slot(step), x);
        }
    }

    void make_planes(int slot, int x) {
        const hn::Repartition<std::int16_t, PlaneTag> numbers;
        const auto invalid = hn::Set(numbers, invalid_);
        PlaneBits low[8];
        PlaneBits high[8];
        PlaneBits measured = hn::Zero(PlaneTag());
        DISPARITYD_UNROLL
        for (int band = 0; band < GuidedBlock::bands; ++band) {
            const auto first = hn::LoadU(numbers, &values_[band][x]);
            const auto second = hn::LoadU(numbers, &values_[band][x + lanes / 2]);
            const auto rejected = hn::ConcatEven(PlaneTag(), bytes(hn::VecFromMask(numbers, hn::Eq(second, invalid))),
                                                 bytes(hn::VecFromMask(numbers, hn::Eq(first, invalid))));
            measured = hn::Or(measured, hn::AndNot(rejected, bit_of(band)));
            const auto least = hn::Set(numbers, least_[band]);
            const auto first_bytes = bytes(hn::Sub(first, least));
            const auto second_bytes = bytes(hn::Sub(second, least));
            low[band] = hn::ConcatEven(PlaneTag(), second_bytes, first_bytes);
            high[band] = hn::ConcatOdd(PlaneTag(), second_bytes, first_bytes);
        }
        hn::StoreU(measured, PlaneTag(), &measured_[slot][x]);
        store_planes(low, 0, slot, x);
        if (bits_ > 8) {
            store_planes(high, 8, slot, x);
        }
    }

    HWY_INLINE void store_planes(PlaneBits (&bytes_of_bands)[8], int first_bit, int slot, int x) {
        transpose_bits(bytes_of_bands);
        DISPARITYD_UNROLL
        for (int i = 0; i < 8; ++i) {
            hn::StoreU(bytes_of_bands[i], PlaneTag(), &planes_[slot][first_bit + i][x]);
        }
    }

    template <class V>
    static HWY_INLINE PlaneBits bytes(V v) {
        return hn::BitCast(PlaneTag(), v);
    }
    static HWY_INLINE PlaneBits bit_of(int band) { return hn::Set(PlaneTag(), static_cast<std::uint8_t>(1 << band)); }

    Plane<const std::int16_t> disparity_;
    Plane<const std::uint8_t> guide_;
    std::int16_t invalid_;
    GuidedBlock block_;
    int bits_ = -1;
    std::int16_t least_[GuidedBlock::bands] = {};
    std::int16_t values_[GuidedBlock::bands][stride];
    std::uint8_t intensities_[ring][GuidedBlock::bands][stride];
    std::uint8_t measured_[ring][stride];
    std::uint8_t planes_[ring][16][stride];
};

/// The medians of a register of columns in all bands.
template <int radius>
class GuidedMedian {
    static constexpr int side = 2 * radius + 1;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(PlaneTag()));
    static constexpr int bits_of_half = 5;

public:
    GuidedMedian(const GuidedSamples<radius>& samples, int step, int x)
        : samples_(samples), step_(step), x_(x), bits_(samples.bits()) {}

    void find() {
        PlaneBits number[6];
        choose_samples(number);
        // The median's bit is set when more samples have it set than lie above the middle.
        PlaneBits above[bits_of_half];
        DISPARITYD_UNROLL
        for (int i = 0; i < bits_of_half; ++i) {
            above[i] = number[i + 1];
        }
        PlaneBits found = hn::Zero(PlaneTag());
        for (int bit = bits_; bit < 16; ++bit) {
            hn::Store(found, PlaneTag(), found_[bit]);
        }
        for (int bit = bits_ - 1; bit >= 0; --bit) {
            bit == bits_ - 1 ? count_set<true>(bit, found, number) : count_set<false>(bit, found, number);
            found = take(number, above);
            hn::Store(found, PlaneTag(), found_[bit]);
        }
    }

    /// The disparities of `band`, of which the first `count` are stored.
    void store(int band, std::int16_t invalid, std::int16_t* out, int count) {
        if (band == 0) {
            to_bytes(0);
            to_bytes(8);
        }
        const hn::Half<PlaneTag> half;
        const std::int16_t least = samples_.least(band);
        const PlaneBits low = hn::Load(PlaneTag(), found_[band]);
        const PlaneBits high = hn::Load(PlaneTag(), found_[8 + band]);
        const PlaneBits measured = hn::And(hn::LoadU(PlaneTag(), samples_.measured(step_) + x_),
                                           hn::Set(PlaneTag(), static_cast<std::uint8_t>(1 << band)));
        store_half(hn::LowerHalf(half, low), hn::LowerHalf(half, high), hn::LowerHalf(half, measured), least, invalid,
                   out, count);
        store_half(hn::UpperHalf(half, low), hn::UpperHalf(half, high), hn::UpperHalf(half, measured), least, invalid,
                   out + lanes / 2, count - lanes / 2);
    }

private:
    // Which samples count, and how many.
    HWY_INLINE void choose_samples(PlaneBits* number) {
        const PlaneBits tolerance = hn::Set(PlaneTag(), static_cast<std::uint8_t>(guided_median_tolerance));
        PlaneBits darkest[GuidedBlock::bands];
        PlaneBits width[GuidedBlock::bands];
        for (int band = 0; band < GuidedBlock::bands; ++band) {
            const PlaneBits own = hn::LoadU(PlaneTag(), samples_.intensities(step_, band) + x_);
            darkest[band] = hn::SaturatedSub(own, tolerance);
            width[band] = hn::Sub(hn::SaturatedAdd(own, tolerance), darkest[band]);
        }
        PlaneBits numbers[3][side];
        for (int dy = 0; dy < side; ++dy) {
            const int step = step_ + dy - radius;
            PlaneBits chosen[side];
            DISPARITYD_UNROLL
            for (int dx = 0; dx < side; ++dx) {
                const int x = x_ + dx - radius;
                PlaneBits like = hn::Zero(PlaneTag());
                DISPARITYD_UNROLL
                for (int band = 0; band < GuidedBlock::bands; ++band) {
                    const PlaneBits other = hn::LoadU(PlaneTag(), samples_.intensities(step, band) + x);
                    like = add_where(at_most(hn::Sub(other, darkest[band]), width[band]), like,
                                     hn::Set(PlaneTag(), static_cast<std::uint8_t>(1 << band)));
                }
                chosen[dx] = hn::And(like, hn::LoadU(PlaneTag(), samples_.measured(step) + x));
                hn::Store(chosen[dx], PlaneTag(), chosen_[dy][dx]);
            }
            count_row(chosen, numbers, dy);
        }
        add_numbers<side>(numbers, number);
    }

    // How many of the chosen samples have a bit set. Those that differ from the median in the bit above are no longer
    // chosen; the first bit has none above it.
    template <bool first>
    HWY_INLINE void count_set(int bit, PlaneBits found_above, PlaneBits* number) {
        PlaneBits numbers[3][side];
        DISPARITYD_UNROLL
        for (int dy = 0; dy < side; ++dy) {
            const std::uint8_t* plane = samples_.plane(step_ + dy - radius, bit) + x_ - radius;
            const std::uint8_t* plane_above = samples_.plane(step_ + dy - radius, first ? bit : bit + 1) + x_ - radius;
            PlaneBits set[side];
            DISPARITYD_UNROLL
            for (int dx = 0; dx < side; ++dx) {
                PlaneBits chosen = hn::Load(PlaneTag(), chosen_[dy][dx]);
                if constexpr (!first) {
                    chosen = where_equal(chosen, hn::LoadU(PlaneTag(), plane_above + dx), found_above);
                    hn::Store(chosen, PlaneTag(), chosen_[dy][dx]);
                }
                set[dx] = hn::And(chosen, hn::LoadU(PlaneTag(), plane + dx));
            }
            count_row(set, numbers, dy);
        }
        add_numbers<side>(numbers, number);
    }

    static HWY_INLINE void count_row(const PlaneBits* bits, PlaneBits (&numbers)[3][side], int row) {
        PlaneBits number[3];
        count_bits<side>(bits, number);
        numbers[0][row] = number[0], numbers[1][row] = number[1], numbers[2][row] = number[2];
    }

    // Whether more samples have the bit set than lie above the middle. Where not, those lie above it themselves, and
    // as many fewer of the rest do.
    static HWY_INLINE PlaneBits take(const PlaneBits* number, PlaneBits (&above)[bits_of_half]) {
        PlaneBits borrow = hn::Zero(PlaneTag());
        PlaneBits rest[bits_of_half];
        DISPARITYD_UNROLL
        for (int i = 0; i < bits_of_half; ++i) {
            rest[i] = sum_of_bits(above[i], number[i], borrow);
            borrow = carry_of_bits(hn::Not(above[i]), number[i], borrow);
        }
        const PlaneBits found = hn::Or(borrow, number[bits_of_half]);
        DISPARITYD_UNROLL
        for (int i = 0; i < bits_of_half; ++i) {
            above[i] = select_bits(found, above[i], rest[i]);
        }
        return found;
    }

    static HWY_INLINE hn::Mask<PlaneTag> at_most(PlaneBits a, PlaneBits b) {
#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
        return hn::Mask<PlaneTag>{_mm512_cmple_epu8_mask(a.raw, b.raw)};
#else
        return hn::Eq(hn::Min(a, b), a);
#endif
    }

    void to_bytes(int first_bit) {
        PlaneBits planes[8];
        DISPARITYD_UNROLL
        for (int i = 0; i < 8; ++i) {
            planes[i] = hn::Load(PlaneTag(), found_[first_bit + i]);
        }
        transpose_bits(planes);
        DISPARITYD_UNROLL
        for (int i = 0; i < 8; ++i) {
            hn::Store(planes[i], PlaneTag(), found_[first_bit + i]);
        }
    }

    template <class V>
    static HWY_INLINE void store_half(V low, V high, V measured, std::int16_t least, std::int16_t invalid,
                                      std::int16_t* out, int count) {
        const hn::Repartition<std::int16_t, PlaneTag> numbers;
        const hn::RebindToUnsigned<decltype(numbers)> words;
        const auto value =
            hn::BitCast(numbers, hn::Or(hn::PromoteTo(words, low), hn::ShiftLeft<8>(hn::PromoteTo(words, high))));
        const auto disparity = hn::Add(value, hn::Set(numbers, least));
        const auto rejected = hn::Eq(hn::PromoteTo(numbers, measured), hn::Zero(numbers));
        const auto result = hn::IfThenElse(rejected, hn::Set(numbers, invalid), disparity);
        if (count >= lanes / 2) {
            hn::StoreU(result, numbers, out);
        } else if (count > 0) {
            alignas(64) std::int16_t last[lanes / 2];
            hn::Store(result, numbers, last);
            std::copy_n(last, count, out);
        }
    }

    const GuidedSamples<radius>& samples_;
    int step_;
    int x_;
    int bits_;
    alignas(64) std::uint8_t chosen_[side][side][lanes];
    alignas(64) std::uint8_t found_[16][lanes];  // planes of bits, then bytes
};

template <int radius>
void guided_median_of_block(Plane<const std::int16_t> in, Plane<const std::uint8_t> guide, std::int16_t invalid,
                            const GuidedBlock& block, Plane<std::int16_t> out) {
    constexpr int lanes = static_cast<int>(hn::MaxLanes(PlaneTag()));
    GuidedSamples<radius> samples(in, guide, invalid, block);
    if (!samples.any()) {
        for (int y = block.rows.first; y < block.rows.last; ++y) {
            std::fill_n(out.row(y) + block.first_column, block.columns, invalid);
        }
        return;
    }
    for (int step = 0; step < block.rows_of_band(); ++step) {
        samples.move_to(step);
        for (int x = 0; x < block.columns; x += lanes) {
            GuidedMedian<radius> median(samples, step, x);
            median.find();
            for (int band = 0; band < GuidedBlock::bands && block.row(band, step) < block.rows.last; ++band) {
                std::int16_t* to = out.row(block.row(band, step)) + block.first_column + x;
                median.store(band, invalid, to, block.columns - x);
            }
        }
    }
}

inline void guided_median(Plane<const std::int16_t> in, Plane<const std::uint8_t> guide, std::int16_t invalid, int size,
                          Plane<std::int16_t> out, Rows rows) {
    for (int first = 0; first < in.width; first += guided_median_columns) {
        const GuidedBlock block{first, std::min(guided_median_columns, in.width - first), rows};
        if (size == 5) {
            guided_median_of_block<2>(in, guide, invalid, block, out);
        } else {
            guided_median_of_block<3>(in, guide, invalid, block, out);
        }
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
