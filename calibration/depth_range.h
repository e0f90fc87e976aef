// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>

#include "kernels/options.h"

namespace disparityd::calibration {

/// The distances that a rectified pair measures with a range of candidates: Z = f B / (d + offset). Distances are
/// metres along the optical axis.
class DepthRange {
public:
    /// `f` in px, `baseline` in mm, `offset` in px, as Rectification has them. Returns nothing where focal length or
    /// baseline is unknown (0).
    static std::optional<DepthRange> of(double f, double baseline_mm, double offset, const MatchOptions& options);

    /// Nothing nearer is measured: f B / (d_max + offset). Infinity when no candidate has a distance.
    double nearest_m() const;

    /// Nothing farther is measured: f B / (d_min + offset). Infinity when there is no such limit.
    double farthest_m() const;

    /// How much farther a point at `distance_m` reads when its disparity is `px` too small. Infinity when it then reads
    /// as infinitely far.
    double error_m(double distance_m, double px) const;

    /// The step of a disparity in px: 1/16, or 1 without subpixels.
    double step_px() const { return step_px_; }

    /// The least number of candidates, a multiple of 16 from the same d_min on, that measures from `nearest` m on.
    /// Nothing when more than 256 would be needed.
    std::optional<int> disparities_for(double nearest) const;

    /// Distances at which the resolution is told.
    static constexpr std::array<double, 2> told_at_m{5, 10};
    /// Near limits for which the number of candidates is told.
    static constexpr std::array<double, 3> wanted_m{1, 0.5, 0.3};

    /// One line for people: both limits, what nearer limits need, the resolution far away.
    std::string text() const;

private:
    std::string limits_text() const;
    std::string wanted_text() const;
    std::string resolution_text() const;

    double f_ = 0;
    double baseline_mm_ = 0;
    double offset_ = 0;
    double step_px_ = 1;
    DisparityRange range_;
};

/// The line for people where DepthRange::of() gives nothing.
inline constexpr const char* unknown_depth_range =
    "which distances are measured is unknown: no calibration says the focal length and the baseline";

}  // namespace disparityd::calibration
