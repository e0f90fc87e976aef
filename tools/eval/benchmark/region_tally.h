// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "tools/eval/benchmark/holes.h"
#include "tools/eval/benchmark/sparsification.h"
#include "tools/eval/means.h"
#include "tools/images/disparity_map.h"

namespace disparityd::eval {

/// A disparity map of any matcher, of the size of the scene it is judged with.
struct JudgedMap {
    images::FloatMap disparity;     ///< +infinity = a hole
    std::vector<float> confidence;  ///< one per pixel, finite, larger is surer; empty = not known
};

/// What one matcher reached in one region of one scene. Counts and sums, so that scenes can be added up.
struct RegionTally {
    static constexpr std::array limits{0.5, 1.0, 2.0, 3.0, 4.0};
    static constexpr std::array quantile_percents{50, 90, 95, 99};

    std::size_t pixels = 0;    ///< of the region, all with truth
    std::size_t measured = 0;  ///< of these, those that have a disparity, before any filling
    std::size_t judged =
        0;  ///< pixels of which `bad` and `d1` are a share: all, or with Holes::left_out those measured
    std::size_t with_error = 0;                    ///< pixels with a disparity, after filling
    std::array<std::size_t, limits.size()> bad{};  ///< more than the limit off, and holes that are judged
    std::size_t d1 = 0;                            ///< KITTI 2015: more than 3 px and more than 5 % off, and holes
    double sum = 0;                                ///< of |disparity - truth| in px
    double sum_of_squares = 0;
    /// Smallest errors in px that so many percent of the pixels with an error do not exceed; NaN where there are none,
    /// and of several scenes together.
    std::array<double, quantile_percents.size()> quantiles = unknown_quantiles();
    std::optional<Sparsification> curves;  ///< where there are confidences and errors

    /// Adds what sums can tell of another scene; quantiles and curves become unknown.
    void add(const RegionTally& other);

    static constexpr std::array<double, quantile_percents.size()> unknown_quantiles() {
        constexpr double nan = std::numeric_limits<double>::quiet_NaN();
        return {nan, nan, nan, nan};
    }
};

/// Judges a map in a region: `pixels` has one value per pixel, 0 = not in it; `filled` is the map after
/// fill_from_background() where holes are filled, otherwise the map's own. All have one size; disparities are not
/// clipped to a range, as Middlebury's program does where it is told one.
RegionTally tally(const JudgedMap& map, const images::FloatMap& filled, const images::FloatMap& truth,
                  const std::vector<std::uint8_t>& pixels, Holes holes);

/// The figures of a tally: density, bad-0.5, bad-1.0, bad-2.0, bad-3.0, bad-4.0 and D1 in percent; the mean (avg, EPE),
/// RMS, A50, A90, A95 and A99 of errors in px; AUSE in px and relative. NaN where it is not known.
std::vector<Figure> benchmark_figures();
std::vector<double> values_of(const RegionTally& tally);

}  // namespace disparityd::eval
