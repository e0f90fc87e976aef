// SPDX-License-Identifier: Apache-2.0
#include "calibration/empty_result/likely_cause.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/core.hpp>

#include "base/number_text.h"
#include "calibration/empty_result/calibration_size.h"
#include "calibration/empty_result/coarse_matches.h"
#include "calibration/empty_result/texture_share.h"
#include "calibration/online/epipolar_fit.h"

namespace disparityd::empty_result {
namespace {

constexpr double least_texture = 0.03;  // of the pixels
constexpr std::size_t least_matches = 12;
constexpr double most_rows = 1;          // px; matching costs are made for less
constexpr double most_of_matches = 0.5;  // share that lies beyond the range

std::string counted_points(std::size_t count, std::size_t all) {
    return std::to_string(count) + " of " + std::to_string(all) + " points that were found in both images";
}

std::optional<LikelyCause> test_texture(const Suspect& suspect) {
    const double left = texture_share(suspect.left);
    const double right = texture_share(suspect.right);
    if (left >= least_texture && right >= least_texture) {
        return std::nullopt;
    }
    const bool one = left >= least_texture || right >= least_texture;
    const std::string where = !one ? "the images have" : left < right ? "the left image has" : "the right image has";
    return LikelyCause{Cause::no_texture,
                       where + " no texture (" + base::fixed(100 * std::min(left, right), 1) +
                           " % of the pixels differ from their surroundings): a covered lens, darkness, too much light "
                           "or a plain wall; there is nothing to match"};
}

/// The measure of self-calibration: the median of |left y - right y|.
double row_error(const std::vector<CoarseMatch>& matches) {
    std::vector<double> sizes;
    for (const CoarseMatch& match : matches) {
        sizes.push_back(std::abs(match.rows));
    }
    return calibration::median(sizes);
}

std::optional<LikelyCause> test_rows(const Suspect& suspect, const std::vector<CoarseMatch>& matches) {
    const double error = row_error(matches);
    if (error < most_rows) {
        return std::nullopt;
    }
    const std::string advice = suspect.calibration && !suspect.calibration->rectified
                                   ? "the calibration does not fit this camera any more: estimate it anew, or try "
                                     "self-calibration"
                                   : "the images are not rectified: give their calibration";
    return LikelyCause{Cause::rows, "the rows of the two images are not aligned: they differ by " +
                                        base::fixed(error, 1) + " px (median of " + std::to_string(matches.size()) +
                                        " points); " + advice};
}

/// How many candidates from `first` on reach `largest`, or what to do where 256 do not.
std::string range_advice(DisparityRange range, double largest) {
    constexpr int unit = 16, most = 256;
    const int needed = static_cast<int>(std::ceil((largest + 1 - range.first) / unit)) * unit;
    if (needed <= most) {
        return std::to_string(needed) + " disparities would reach them";
    }
    return "with d_min " + std::to_string(range.first) +
           " the 256 that there are do not reach them: take smaller images";
}

std::optional<LikelyCause> test_range(const Suspect& suspect, const std::vector<CoarseMatch>& matches) {
    std::vector<double> sorted;
    for (const CoarseMatch& match : matches) {
        sorted.push_back(match.disparity);
    }
    std::sort(sorted.begin(), sorted.end());
    const double first = suspect.range.first - 1, last = suspect.range.first + suspect.range.count;
    const auto below = static_cast<std::size_t>(std::lower_bound(sorted.begin(), sorted.end(), first) - sorted.begin());
    const auto above = static_cast<std::size_t>(sorted.end() - std::upper_bound(sorted.begin(), sorted.end(), last));
    const double enough = most_of_matches * static_cast<double>(sorted.size());
    const double low = sorted[sorted.size() / 20], high = sorted[sorted.size() - 1 - sorted.size() / 20];
    const std::string found = base::fixed(low, 0) + " to " + base::fixed(high, 0) + " px";
    if (static_cast<double>(above) > enough) {
        return LikelyCause{Cause::range,
                           "the range of disparities is too small: " + counted_points(above, sorted.size()) +
                               " lie beyond the " + std::to_string(suspect.range.first) + " to " +
                               std::to_string(suspect.range.first + suspect.range.count - 1) +
                               " px that are searched, at " + found + "; " + range_advice(suspect.range, high)};
    }
    if (static_cast<double>(below) <= enough) {
        return std::nullopt;
    }
    if (sorted[sorted.size() / 2] > 0) {
        return LikelyCause{
            Cause::range, "d_min is too large: " + counted_points(below, sorted.size()) + " lie below it, at " + found};
    }
    return LikelyCause{Cause::eyes_exchanged, "left and right are exchanged: " + counted_points(below, sorted.size()) +
                                                  " have negative disparities, " + found +
                                                  "; exchange the two images (only cameras that converge need a "
                                                  "negative d_min instead)"};
}

/// Matches the left image with the right one as it would be after it was turned or mirrored back.
std::optional<LikelyCause> test_turned(const Suspect& suspect, std::size_t matches) {
    constexpr std::size_t clear_ratio = 3;
    const cv::Mat right(suspect.right.height, suspect.right.width, CV_8UC1,
                        const_cast<std::uint8_t*>(suspect.right.data), static_cast<std::size_t>(suspect.right.stride));
    for (const auto& [code, what] : {std::pair(-1, "upside down"), {1, "mirrored left to right"}}) {
        cv::Mat back;
        cv::flip(right, back, code);
        const std::size_t found =
            coarse_matches(suspect.left, {back.data, back.cols, back.rows, static_cast<std::ptrdiff_t>(back.step)})
                .size();
        if (found >= clear_ratio * std::max(matches, least_matches)) {
            return LikelyCause{Cause::turned, std::string("one of the two images is ") + what +
                                                  " against the other one: " + std::to_string(found) +
                                                  " points are found in both once it is turned back; turn it, or set "
                                                  "the camera to do so"};
        }
    }
    return std::nullopt;
}

}  // namespace

std::optional<LikelyCause> other_resolution(const std::optional<calibration::StereoCalibration>& calibration) {
    const auto ratio = calibration ? size_of_calibration(*calibration) : std::nullopt;
    if (!ratio) {
        return std::nullopt;
    }
    return LikelyCause{Cause::other_resolution,
                       "the calibration " + calibration->origin + " is of another resolution: its principal point (" +
                           base::fixed(calibration->left.cx, 0) + ", " + base::fixed(calibration->left.cy, 0) +
                           ") belongs to images about " + base::fixed(*ratio, 2) + " times as large as these, " +
                           std::to_string(calibration->width) + "x" + std::to_string(calibration->height) +
                           "; use the calibration of this size"};
}

LikelyCause likely_cause(const Suspect& suspect) {
    if (auto found = other_resolution(suspect.calibration)) {
        return *found;
    }
    if (auto found = test_texture(suspect)) {
        return *found;
    }
    const std::vector<CoarseMatch> matches = coarse_matches(suspect.left, suspect.right);
    // Few points are found by chance.
    const bool few = matches.size() < 3 * least_matches;
    if (auto found = few ? test_turned(suspect, matches.size()) : std::nullopt) {
        return *found;
    }
    if (matches.size() >= least_matches) {
        if (auto found = test_rows(suspect, matches)) {
            return *found;
        }
        if (auto found = test_range(suspect, matches)) {
            return *found;
        }
    }
    return {Cause::unknown,
            "not known: calibration and resolution, texture, rows, the order of the eyes and the range look right, or "
            "the two images have too little in common (" +
                std::to_string(matches.size()) + " points were found in both)"};
}

}  // namespace disparityd::empty_result
