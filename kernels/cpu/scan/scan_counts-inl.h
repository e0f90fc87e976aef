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

#include "hwy/highway.h"
#include "kernels/reference/steps.h"
#include "kernels/scan/scan_counts.h"
#include "kernels/steps.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Sorts the pixels of a row into bins and counts them.
class ScanBins {
    using Numbers = hn::ScalableTag<std::int16_t>;
    using Words = hn::RebindToUnsigned<Numbers>;
    using Bytes = hn::Rebind<std::uint8_t, Numbers>;
    using V = hn::Vec<Numbers>;
    using Mask = hn::Mask<Numbers>;

public:
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Numbers()));

    ScanBins(const scan::Geometry& geometry, const scan::Band& band)
        : band_(band),
          offset_(number(std::clamp(geometry.camera().scale.offset16, -32768, 32767))),
          too_unsure_(number(geometry.options().min_confidence - 1)),
          too_far_(number(geometry.limits().seen - 1)),
          no_obstacle_(number(geometry.limits().obstacle - 1)),
          too_near_(number(geometry.limits().nearest + 1)) {}

    /// Adds the pixels of a row to `count`, at the counters of their columns, and adds 1 to `seen` where one is known.
    /// `kept` gets their bins, if it is not null.
    HWY_INLINE void row(const scan::Pixels& pixels, const std::uint16_t* weights, int y, const std::uint32_t* counters,
                        std::uint32_t* count, std::int16_t* seen, std::uint8_t* kept) const {
        const V low_of_row = hn::Set(Numbers(), band_.low_of_row(y));
        const V high_of_row = hn::Set(Numbers(), band_.high_of_row(y));
        const int width = pixels.disparity.width;
        HWY_ALIGN std::array<std::uint8_t, lanes> bins;
        for (int begin = 0; begin < width; begin += lanes) {
            const int x = std::min(begin, width - lanes);
            const V n = hn::SaturatedAdd(hn::LoadU(Numbers(), pixels.disparity.row(y) + x), offset_);
            const V confidence = hn::PromoteTo(Numbers(), hn::LoadU(Bytes(), pixels.confidence.row(y) + x));
            const V positive = hn::Min(hn::Max(n, hn::Zero(Numbers())), hn::Set(Numbers(), 16383));
            const V weight = hn::BitCast(Numbers(), hn::LoadU(Words(), weights + x));
            const V at_distance = hn::MulFixedPoint15(hn::Add(positive, positive), weight);
            const Mask measured = hn::And(hn::Gt(confidence, hn::Zero(Numbers())),
                                          hn::And(hn::Gt(at_distance, too_far_), hn::Gt(too_near_, at_distance)));
            const V low = hn::Add(hn::LoadU(Numbers(), band_.low_of_columns() + x), low_of_row);
            const V high = hn::Add(hn::LoadU(Numbers(), band_.high_of_columns() + x), high_of_row);
            const Mask below_high = band_.above() ? hn::Lt(n, high) : hn::Gt(n, high);
            const Mask in_band = hn::And(below_high, hn::Not(hn::Gt(low, n)));
            const Mask obstacle = hn::And(hn::And(measured, hn::Gt(at_distance, no_obstacle_)), in_band);
            const Mask counts = hn::And(obstacle, hn::Gt(confidence, too_unsure_));

            // What may be an obstacle, but is unsure, says nothing.
            Mask known = hn::Or(counts, hn::AndNot(obstacle, measured));
            if (x < begin) {
                // The last vector overlaps the one before it: what that has counted is not counted again.
                const V columns = hn::Iota(Numbers(), static_cast<std::int16_t>(x));
                known = hn::And(known, hn::Gt(columns, number(begin - 1)));
            }
            hn::StoreU(hn::Sub(hn::LoadU(Numbers(), seen + x), hn::VecFromMask(Numbers(), known)), Numbers(), seen + x);

            const bool any = !hn::AllFalse(Numbers(), counts);
            if (any || kept != nullptr) {
                const V bin = hn::IfThenElse(counts, bin_of(at_distance), hn::Set(Numbers(), scan::no_bin));
                hn::Store(hn::DemoteTo(Bytes(), bin), Bytes(), bins.data());
            }
            if (kept != nullptr) {
                std::copy(bins.begin(), bins.end(), kept + x);
            }
            if (any) {
                for (int i = begin - x; i < lanes; ++i) {
                    ++count[counters[x + i] + bins[static_cast<std::size_t>(i)]];
                }
            }
        }
    }

private:
    static HWY_INLINE V number(int value) { return hn::Set(Numbers(), static_cast<std::int16_t>(value)); }

    static HWY_INLINE V bin_of(V sixteenths) {
        const V quarters = hn::Min(hn::ShiftRight<2>(sixteenths), hn::Set(Numbers(), scan::largest_quarters));
        static_assert(scan::max_shift == 6);
        V bin = quarters;
        bin = hn::Min(bin, hn::Add(hn::ShiftRight<1>(quarters), hn::Set(Numbers(), 32)));
        bin = hn::Min(bin, hn::Add(hn::ShiftRight<2>(quarters), hn::Set(Numbers(), 64)));
        bin = hn::Min(bin, hn::Add(hn::ShiftRight<3>(quarters), hn::Set(Numbers(), 96)));
        bin = hn::Min(bin, hn::Add(hn::ShiftRight<4>(quarters), hn::Set(Numbers(), 128)));
        bin = hn::Min(bin, hn::Add(hn::ShiftRight<5>(quarters), hn::Set(Numbers(), 160)));
        return hn::Min(bin, hn::Add(hn::ShiftRight<6>(quarters), hn::Set(Numbers(), 192)));
    }

    const scan::Band& band_;
    V offset_;
    V too_unsure_;
    V too_far_;
    V no_obstacle_;
    V too_near_;
};

/// Where the counters of each column's sector begin; columns without a sector have those that nobody reads.
inline void find_counters(const scan::Geometry& geometry, int group, int width, std::uint32_t* counters) {
    const std::int16_t* edges = geometry.edges(group);
    const auto none = static_cast<std::uint32_t>(geometry.sectors() * scan::bins);
    std::fill_n(counters, width, none);
    for (int s = 0; s < geometry.sectors(); ++s) {
        std::fill(counters + edges[s + 1], counters + edges[s], static_cast<std::uint32_t>(s * scan::bins));
    }
}

inline void scan_counts(const scan::Pixels& pixels, const scan::Geometry& geometry, const scan::Band& band,
                        scan::Counts& counts) {
    const int width = pixels.disparity.width;
    if (width < ScanBins::lanes) {
        reference::scan_counts(pixels, geometry, band, counts);
        return;
    }
    std::fill(counts.obstacle.begin(), counts.obstacle.end(), 0);
    const ScanBins row_bins(geometry, band);
    std::array<std::int16_t, max_side> seen;
    std::array<std::uint32_t, max_side> counters;
    std::uint32_t* count = counts.obstacle.data();
    for (int group = 0; group < counts.groups; ++group) {
        find_counters(geometry, group, width, counters.data());
        std::fill_n(seen.data(), width, std::int16_t{0});
        for (int y = group * scan::group_rows; y < geometry.group_end(group); ++y) {
            std::uint8_t* const kept = y == geometry.group_middle(group) ? counts.middle_bins_of(group) : nullptr;
            row_bins.row(pixels, geometry.weights(group), y, counters.data(), count, seen.data(), kept);
        }
        const std::int16_t* edges = geometry.edges(group);
        for (int s = 0; s < counts.sectors; ++s) {
            int sum = 0;
            for (int x = edges[s + 1]; x < edges[s]; ++x) {
                sum += seen[static_cast<std::size_t>(x)];
            }
            counts.seen_of(s, group) = static_cast<std::uint32_t>(sum);
        }
    }
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
