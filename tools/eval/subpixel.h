// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/eval/means.h"
#include "tools/images/disparity_map.h"

namespace disparityd::eval {

/// How good the fractions of a disparity map are, over the pixels with known truth that both cameras see (all with
/// truth where that is not known). Shares are percentages; NaN where there is no such pixel.
struct SubpixelAccuracy {
    double bad05 = 0;           ///< off by more than 0.5 px, or rejected
    double bad05_measured = 0;  ///< off by more than 0.5 px, of those that have a disparity
    double rms = 0;             ///< px, of those that are off by at most 1 px
    /// Of those that have a disparity: at most 1/16 px from a whole number. Spread evenly it would be 3 of 16 values,
    /// 18.75 %; more is a fit that is drawn to whole numbers.
    double near_whole = 0;
    double truth_near_whole = 0;            ///< the same of their ground truth, rounded to 1/16 px
    std::array<double, 16> fractions = {};  ///< share of each sixteenth
};

/// `non_occluded` as measure() has it. Throws std::invalid_argument when the sizes differ.
SubpixelAccuracy measure_subpixel(const images::FloatMap& disparity, const images::FloatMap& truth,
                                  const std::vector<std::uint8_t>& non_occluded);

struct SubpixelRow {
    std::string scene;
    std::string method;
    std::string backend;
    int disparities = 0;
    SubpixelAccuracy accuracy;
};

/// A line per row, then the mean over the scenes for each method.
void print_subpixel_table(const std::vector<SubpixelRow>& rows, bool markdown, std::ostream& to);

/// Returns the figures of print_subpixel_table() for each row, without disparities.
Measurements measurements(const std::vector<SubpixelRow>& rows);

/// Returns a list of objects: scene, method, backend, disparities, bad05_nonocc, bad05_measured, rms_px, near_whole,
/// truth_near_whole, fractions (16 numbers); null where no pixel is judged.
nlohmann::ordered_json subpixel_json(const std::vector<SubpixelRow>& rows);

}  // namespace disparityd::eval
