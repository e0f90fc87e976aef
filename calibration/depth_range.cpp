// SPDX-License-Identifier: Apache-2.0
#include "calibration/depth_range.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace disparityd::calibration {
namespace {

constexpr double no_limit = std::numeric_limits<double>::infinity();

std::string printed(const char* format, double value) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), format, value);
    return text.data();
}

std::string metres_text(double value) {
    if (std::isinf(value)) {
        return "without limit";
    }
    return printed(value < 0.1 ? "%.2g m" : value < 10 ? "%.2f m" : "%.1f m", value);
}

/// A near limit is rounded up: never told as nearer than it is.
std::string near_limit_text(double value) {
    return metres_text(std::ceil(value * 100 - 1e-6) / 100);
}

std::string four_digits(double value) {
    return printed("%.4g", value);
}

}  // namespace

std::optional<DepthRange> DepthRange::of(double f, double baseline_mm, double offset, const MatchOptions& options) {
    if (!(f > 0) || !(baseline_mm > 0)) {
        return std::nullopt;
    }
    DepthRange depths;
    depths.f_ = f;
    depths.baseline_mm_ = baseline_mm;
    depths.offset_ = offset;
    constexpr double finest_step = 1.0 / 16;
    depths.step_px_ = options.post.subpixel ? finest_step : 1;
    depths.range_ = options.range;
    return depths;
}

double DepthRange::nearest_m() const {
    const double largest = range_.first + range_.count - 1 + offset_;
    return largest > 0 ? f_ * baseline_mm_ / 1000 / largest : no_limit;
}

double DepthRange::farthest_m() const {
    const double smallest = range_.first + offset_;
    return smallest > 0 ? f_ * baseline_mm_ / 1000 / smallest : no_limit;
}

double DepthRange::error_m(double distance_m, double px) const {
    const double fb = f_ * baseline_mm_ / 1000;
    const double disparity = fb / distance_m - px;
    return disparity > 0 ? fb / disparity - distance_m : no_limit;
}

std::optional<int> DepthRange::disparities_for(double nearest) const {
    constexpr int unit = 16, most = 256;
    constexpr double rounding = 1e-9;
    const double largest = f_ * baseline_mm_ / 1000 / nearest - offset_;
    const double count = std::ceil((largest - range_.first + 1) / unit - rounding) * unit;
    if (!(count <= most)) {
        return std::nullopt;
    }
    return std::max(unit, static_cast<int>(count));
}

std::string DepthRange::limits_text() const {
    const double largest = range_.first + range_.count - 1 + offset_;
    const std::string geometry = "disparities up to " + four_digits(largest) + " px, f " + four_digits(f_) +
                                 " px, baseline " + four_digits(baseline_mm_) + " mm";
    if (std::isinf(nearest_m())) {
        return "no distance is measured: no disparity is above 0 with its offset (" + geometry + ")";
    }
    const std::string beyond =
        std::isinf(farthest_m()) ? "" : ", nor farther than " + metres_text(std::floor(farthest_m() * 100) / 100) + ",";
    return "nothing nearer than " + near_limit_text(nearest_m()) + beyond + " is measured (" + geometry + ")";
}

std::string DepthRange::wanted_text() const {
    std::string text;
    for (const double wanted : wanted_m) {
        if (wanted >= nearest_m()) {
            continue;
        }
        const auto needed = disparities_for(wanted);
        text += (text.empty() ? "; " : ", ") + four_digits(wanted) + " m needs " +
                (needed ? std::to_string(*needed) + " disparities" : "more than the 256 that there are");
        if (!needed) {
            return text + ": take a smaller mode or size";
        }
    }
    return text;
}

std::string DepthRange::resolution_text() const {
    std::string text;
    for (const double distance : told_at_m) {
        if (distance < nearest_m() || distance > farthest_m()) {
            continue;
        }
        const std::string step = step_px_ < 1 ? "1/16 px" : "1 px";
        text += "; at " + four_digits(distance) + " m a step of " + step + " is " +
                metres_text(error_m(distance, step_px_));
        text += step_px_ < 1 ? ", an error of 1 px " + metres_text(error_m(distance, 1)) : "";
    }
    return text;
}

std::string DepthRange::text() const {
    return limits_text() + wanted_text() + resolution_text();
}

}  // namespace disparityd::calibration
