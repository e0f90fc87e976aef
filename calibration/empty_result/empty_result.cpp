// SPDX-License-Identifier: Apache-2.0
#include "calibration/empty_result/empty_result.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "base/number_text.h"
#include "calibration/calibration.h"
#include "calibration/grey_view.h"
#include "calibration/online/corner_matches.h"
#include "calibration/online/epipolar_fit.h"
#include "kernels/image.h"

namespace disparityd::empty_result {
namespace {

/// Where a point of the left image lies in the right one, in px of the whole image.
struct CoarseMatch {
    double disparity = 0;  ///< left x - right x
    double rows = 0;       ///< left y - right y
};

constexpr int reduced_width = 340;
constexpr int rows_searched = 16;  // of the reduced image

cv::Mat shrunk(Plane<const std::uint8_t> image, int reduction) {
    const cv::Mat whole = calibration::grey_view(image);
    cv::Mat small;
    cv::resize(whole, small, {image.width / reduction, image.height / reduction}, 0, 0, cv::INTER_AREA);
    return small;
}

Plane<const std::uint8_t> plane_of(const cv::Mat& image) {
    return {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step)};
}

/// Matches corners as self-calibration does (calibration/online/corner_matches.h), on reduced images and far beyond any
/// range: disparities up to half the width to both sides, and several rows up and down. Some 0.2 s. The images have one
/// size.
std::vector<CoarseMatch> coarse_matches(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right) {
    const int reduction = std::max(1, (left.width + reduced_width - 1) / reduced_width);
    const cv::Mat small_left = shrunk(left, reduction);
    const cv::Mat small_right = shrunk(right, reduction);
    const int reach = small_left.cols / 2;
    std::vector<CoarseMatch> matches;
    for (const calibration::CornerMatch& match : calibration::match_corners(plane_of(small_left), plane_of(small_right),
                                                                            {-reach, 2 * reach + 1}, rows_searched)) {
        matches.push_back({(match.left_x - match.right_x) * reduction, (match.left_y - match.right_y) * reduction});
    }
    return matches;
}

/// How much larger, in both directions, the pictures were that a calibration was made of than the frames that it is
/// used for, as its principal points tell: cameras have them near the middle. Nothing where it fits, or where the
/// principal points say nothing.
std::optional<double> size_of_calibration(const calibration::StereoCalibration& calibration) {
    if (calibration.left.fx == 0) {
        return std::nullopt;  // rectified images of which nothing else is known
    }
    // HD2K and HD1080 differ by 1.15. Rectification moves the principal point of images that are rectified already.
    const double least = calibration.rectified ? 1.35 : 1.1;
    const auto of_width = [&](double centre) { return 2 * centre / calibration.width; };
    const auto of_height = [&](double centre) { return 2 * centre / calibration.height; };
    const std::array<double, 4> ratios{of_width(calibration.left.cx), of_height(calibration.left.cy),
                                       of_width(calibration.right.cx), of_height(calibration.right.cy)};
    const auto [smallest, largest] = std::minmax_element(ratios.begin(), ratios.end());
    if (*smallest<least&& * largest> 1 / least) {
        return std::nullopt;
    }
    double product = 1;
    for (const double ratio : ratios) {
        product *= std::max(ratio, 1e-3);
    }
    return std::pow(product, 0.25);
}

constexpr int shrink = 4;
// A second difference: a ramp has none. Noise of 3 grey levels has a deviation of 4.5 in the reduced image.
constexpr int least_change = 18;

/// The share of an image, 0 .. 1, that has something to match: where brightness changes by more than noise, a ramp or
/// vignetting do. Measured on the image at a quarter of its size, where noise is small.
double texture_share(Plane<const std::uint8_t> image) {
    const cv::Mat whole = calibration::grey_view(image);
    const cv::Size size(std::max(image.width / shrink, 3), std::max(image.height / shrink, 3));
    cv::Mat reduced, change;
    cv::resize(whole, reduced, size, 0, 0, cv::INTER_AREA);
    cv::Sobel(reduced, change, CV_16S, 2, 0);
    change = change.colRange(1, change.cols - 1);  // a ramp has an edge at the border, which is mirrored
    const auto strong = std::count_if(change.begin<std::int16_t>(), change.end<std::int16_t>(),
                                      [](std::int16_t value) { return std::abs(value) >= least_change; });
    return static_cast<double>(strong) / static_cast<double>(change.total());
}

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
    const cv::Mat right = calibration::grey_view(suspect.right);
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

std::vector<std::uint8_t> copy_of(Plane<const std::uint8_t> plane) {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(static_cast<std::size_t>(plane.width) * static_cast<std::size_t>(plane.height));
    for (int y = 0; y < plane.height; ++y) {
        bytes.insert(bytes.end(), plane.row(y), plane.row(y) + plane.width);
    }
    return bytes;
}

bool are_alike(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right) {
    for (int y = 0; y < left.height; ++y) {
        if (!std::equal(left.row(y), left.row(y) + left.width, right.row(y))) {
            return false;
        }
    }
    return true;
}

std::string percent(double share) {
    return base::fixed(100 * share, 1) + " %";
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

std::uint64_t measured_pixels(Plane<const std::uint8_t> confidence) {
    std::uint64_t measured = 0;
    for (int y = 0; y < confidence.height; ++y) {
        const std::uint8_t* row = confidence.row(y);
        measured += static_cast<std::uint64_t>(
            std::count_if(row, row + confidence.width, [](std::uint8_t value) { return value != 0; }));
    }
    return measured;
}

void EmptyResult::add(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right,
                      Plane<const std::uint8_t> confidence) {
    const std::uint64_t measured = measured_pixels(confidence);
    const auto pixels = static_cast<std::uint64_t>(confidence.width) * static_cast<std::uint64_t>(confidence.height);
    pixels_ += pixels;
    measured_ += measured;
    alike_ = alike_ && are_alike(left, right);
    if (kept_.size() < most_kept && static_cast<double>(measured) < suspicious_below * static_cast<double>(pixels)) {
        kept_.push_back({left.width, left.height, copy_of(left), copy_of(right)});
    }
}

double EmptyResult::measured() const {
    return pixels_ == 0 ? 1 : static_cast<double>(measured_) / static_cast<double>(pixels_);
}

LikelyCause EmptyResult::cause(const std::optional<calibration::StereoCalibration>& calibration) const {
    std::vector<LikelyCause> found;
    for (const Pair& pair : kept_) {
        const auto plane = [&pair](const std::vector<std::uint8_t>& bytes) {
            return Plane<const std::uint8_t>{bytes.data(), pair.width, pair.height, pair.width};
        };
        found.push_back(likely_cause({plane(pair.left), plane(pair.right), range_, calibration}));
    }
    for (const LikelyCause& one : found) {
        const auto same = std::count_if(found.begin(), found.end(),
                                        [&one](const LikelyCause& other) { return other.cause == one.cause; });
        if (2 * static_cast<std::size_t>(same) > found.size()) {
            return one;
        }
    }
    return {Cause::unknown, "not known: the frames look as if they had several"};
}

std::string EmptyResult::note(const std::optional<calibration::StereoCalibration>& calibration) const {
    if (measured() >= suspicious_below) {
        if (alike_ && pixels_ > 0) {
            return "both eyes show the same picture, so that all of it reads as infinitely far: give the image of each "
                   "eye";
        }
        const auto wrong = other_resolution(calibration);
        return wrong ? "the disparities are likely to be wrong: " + wrong->text : "";
    }
    const LikelyCause found = cause(calibration);
    if (!is_told(found, measured())) {
        return {};
    }
    return "only " + percent(measured()) + " of the pixels were measured; the likely cause: " + found.text;
}

}  // namespace disparityd::empty_result
