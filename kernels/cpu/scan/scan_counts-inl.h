// SPDX-License-Identifier: Apache-2.0
// Step 14 of docs/algorithm.md, the part that looks at every pixel: bins of a row in vectors, then counted one by one.
#if defined(DISPARITYD_CPU_SCAN_SCAN_COUNTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_SCAN_SCAN_COUNTS_INL_H_
#undef DISPARITYD_CPU_SCAN_SCAN_COUNTS_INL_H_
#else
#define DISPARITYD_CPU_SCAN_SCAN_COUNTS_INL_H_
#endif

#include <algorithm>
#include <array>
#include <cstdint>

#include "kernels/cpu/simd/lanes-inl.h"
#include "kernels/reference/steps.h"
#include "kernels/scan_counts.h"
#include "kernels/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Finds the bins of a row's pixels, and where their counters are.
class ScanBins {
    using Numbers = hn::ScalableTag<std::int16_t>;
    using Words = hn::RebindToUnsigned<Numbers>;
    using Places = hn::RepartitionToWide<Words>;
    using Bytes = hn::Rebind<std::uint8_t, Numbers>;
    using V = hn::Vec<Numbers>;
    using Mask = hn::Mask<Numbers>;

public:
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Numbers()));

    ScanBins(const scan::Pixels& pixels, const scan::CountTables& tables)
        : pixels_(pixels),
          tables_(tables),
          flip_(number(tables.above ? -1 : 0)),
          offset_(number(std::clamp(tables.offset16, -32768, 32767))),
          too_unsure_(number(tables.min_confidence - 1)),
          too_far_(number(tables.limits.seen - 1)),
          no_obstacle_(number(tables.limits.obstacle - 1)),
          too_near_(number(tables.limits.nearest + 1)) {}

    /// Adds 1 to `seen` in the columns whose pixel of this row is known. `places` gets where the counters of obstacle
    /// pixels are, and some that nobody reads; returns how many. `kept` gets the bins, if it is not null.
    HWY_INLINE std::size_t row(int group, int y, std::int16_t* seen, std::uint32_t* places, std::uint8_t* kept) const {
        const std::int16_t* const disparity = pixels_.disparity.row(y);
        const std::uint8_t* const sureness = pixels_.confidence.row(y);
        const std::uint16_t* const weights = tables_.weights.row(group);
        const std::uint16_t* const sectors = tables_.sectors_of_columns.row(group);
        const std::int16_t* const low_of_columns = tables_.low_of_columns;
        const std::int16_t* const high_of_columns = tables_.high_of_columns;
        const V low_of_row = hn::Set(Numbers(), tables_.low_of_rows[y]);
        const V high_of_row = hn::Set(Numbers(), tables_.high_of_rows[y]);
        const int width = pixels_.disparity.width;
        std::size_t placed = 0;
        for (int begin = 0; begin < width; begin += lanes) {
            const int x = std::min(begin, width - lanes);
            const V n = hn::SaturatedAdd(hn::LoadU(Numbers(), disparity + x), offset_);
            const V confidence = hn::PromoteTo(Numbers(), hn::LoadU(Bytes(), sureness + x));
            const V at_most = hn::Min(n, hn::Set(Numbers(), 16383));
            const V weight = hn::BitCast(Numbers(), hn::LoadU(Words(), weights + x));
            const V at_distance = hn::MulFixedPoint15(hn::SaturatedAdd(at_most, at_most), weight);
            const Mask measured = hn::And(hn::Gt(confidence, hn::Zero(Numbers())),
                                          hn::And(hn::Gt(at_distance, too_far_), hn::Gt(too_near_, at_distance)));
            const V low = hn::Add(hn::LoadU(Numbers(), low_of_columns + x), low_of_row);
            const V high = hn::Add(hn::LoadU(Numbers(), high_of_columns + x), high_of_row);
            const Mask below_high = hn::Gt(hn::Xor(n, flip_), hn::Xor(high, flip_));
            const Mask in_band = hn::AndNot(hn::Gt(low, n), below_high);
            const Mask obstacle = hn::And(hn::And(measured, hn::Gt(at_distance, no_obstacle_)), in_band);
            Mask counts = hn::And(obstacle, hn::Gt(confidence, too_unsure_));

            // What may be an obstacle, but is unsure, says nothing.
            Mask known = hn::Or(counts, hn::AndNot(obstacle, measured));
            if (kept != nullptr) {
                const V bin = hn::IfThenElse(counts, bin_of(at_distance), hn::Set(Numbers(), scan::no_bin));
                hn::StoreU(hn::DemoteTo(Bytes(), bin), Bytes(), kept + x);
            }
            if (x < begin) {
                // The last vector overlaps the one before it: what that has counted is not counted again.
                const Mask fresh = hn::Gt(numbers_from(Numbers(), static_cast<std::int16_t>(x)), number(begin - 1));
                known = hn::And(known, fresh);
                counts = hn::And(counts, fresh);
            }
            hn::StoreU(hn::Sub(hn::LoadU(Numbers(), seen + x), hn::VecFromMask(Numbers(), known)), Numbers(), seen + x);
            if (!hn::AllFalse(Numbers(), counts)) {
                const V bin = hn::IfThenElse(counts, bin_of(at_distance), hn::Set(Numbers(), scan::no_bin));
                find_places(hn::BitCast(Words(), bin), hn::LoadU(Words(), sectors + x), places + placed);
                placed += lanes;
            }
        }
        return placed;
    }

private:
    static HWY_INLINE V number(int value) { return hn::Set(Numbers(), static_cast<std::int16_t>(value)); }

    static HWY_INLINE V bin_of(V sixteenths) {
        const V quarters = hn::Min(hn::ShiftRight<2>(sixteenths), hn::Set(Numbers(), scan::largest_quarters));
        static_assert(scan::max_shift == 6);
        V bin = quarters;
        bin = hn::Min(bin, hn::Add(hn::ShiftRight<1>(quarters), hn::Set(Numbers(), 32)));
        bin = hn::Min(bin, hn::Add(hn::ShiftRight<2>(quarters), hn::Set(Numbers(), 64)));
        // Hardly anything is nearer than 64 px.
        if (HWY_LIKELY(hn::AllFalse(Numbers(), hn::Gt(quarters, hn::Set(Numbers(), 256))))) {
            return bin;
        }
        bin = hn::Min(bin, hn::Add(hn::ShiftRight<3>(quarters), hn::Set(Numbers(), 96)));
        bin = hn::Min(bin, hn::Add(hn::ShiftRight<4>(quarters), hn::Set(Numbers(), 128)));
        bin = hn::Min(bin, hn::Add(hn::ShiftRight<5>(quarters), hn::Set(Numbers(), 160)));
        return hn::Min(bin, hn::Add(hn::ShiftRight<6>(quarters), hn::Set(Numbers(), 192)));
    }

    /// Where the counters of these bins of these sectors are, in any order.
    static HWY_INLINE void find_places(hn::Vec<Words> bins, hn::Vec<Words> sectors, std::uint32_t* places) {
        static_assert(scan::bins == 256);
        const auto low = hn::Or(hn::ShiftLeft<8>(sectors), bins);
        const auto high = hn::ShiftRight<8>(sectors);
        hn::Store(hn::ZipLower(Places(), low, high), Places(), places);
        hn::Store(hn::ZipUpper(Places(), low, high), Places(), places + lanes / 2);
    }

    const scan::Pixels pixels_;
    const scan::CountTables& tables_;
    V flip_;  ///< all bits where a pixel has to be less than the high limit, which turns the order around
    V offset_;
    V too_unsure_;
    V too_far_;
    V no_obstacle_;
    V too_near_;
};

inline void scan_counts(const scan::Pixels& pixels, const scan::CountTables& tables, scan::Counts& counts) {
    const int width = pixels.disparity.width;
    const int height = pixels.disparity.height;
    if (width < ScanBins::lanes) {
        reference::scan_counts(pixels, tables, counts);
        return;
    }
    std::fill(counts.obstacle.begin(), counts.obstacle.end(), 0);
    const ScanBins bins(pixels, tables);
    std::array<std::int16_t, max_side> seen;
    std::array<std::int32_t, max_side + 1> seen_before;  // in the columns before this one
    HWY_ALIGN std::array<std::uint32_t, max_side + ScanBins::lanes> places;
    std::uint32_t* const count = counts.obstacle.data();
    for (int group = 0; group < counts.groups; ++group) {
        std::fill_n(seen.data(), width, std::int16_t{0});
        for (int y = group * scan::group_rows, end = scan::group_end(group, height); y < end; ++y) {
            std::uint8_t* const kept = y == scan::group_middle(group, height) ? counts.middle_bins_of(group) : nullptr;
            const std::size_t placed = bins.row(group, y, seen.data(), places.data(), kept);
            for (std::size_t i = 0; i < placed; ++i) {
                ++count[places[i]];
            }
            if (kept != nullptr) {
                counts.middle_counted[static_cast<std::size_t>(group)] = placed > 0 ? 1 : 0;
            }
        }
        seen_before[0] = 0;
        for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x) {
            seen_before[x + 1] = seen_before[x] + seen[x];
        }
        const std::int16_t* edges = tables.edges.row(group);
        for (int s = 0; s < counts.sectors; ++s) {
            counts.seen_of(s, group) = static_cast<std::uint32_t>(seen_before[static_cast<std::size_t>(edges[s])] -
                                                                  seen_before[static_cast<std::size_t>(edges[s + 1])]);
        }
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
