// SPDX-License-Identifier: Apache-2.0
#include "calibration/online/self_calibration.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <opencv2/core/matx.hpp>

#include "calibration/online/corner_matches.h"

namespace disparityd::calibration {

namespace {

constexpr int blocks_across = 8;
constexpr int blocks_down = 6;
constexpr int blocks = blocks_across * blocks_down;

// The conditions for a well-determined correction. Deviations are in px of a rectified image.
constexpr int least_matches = 100;
constexpr int least_blocks = blocks / 4;
constexpr double least_inliers = 0.5;
constexpr double largest_pitch_deviation = 0.05;
constexpr double largest_roll_deviation = 0.1;        // at the side of the image
constexpr double largest_disparity_deviation = 0.05;  // what yaw and focal length do there
constexpr double least_gain = 0.02;                   // px, of the median error of unseen pairs
constexpr double largest_turn = 1.5 * std::numbers::pi / 180;

cv::Vec2d direction(const std::array<double, 9>& rotation, double x, double y) {
    const cv::Vec3d ray = cv::Matx33d(rotation.data()).t() * cv::Vec3d(x, y, 1);
    return {ray[0] / ray[2], ray[1] / ray[2]};
}

std::int32_t billionths(double value) {
    return static_cast<std::int32_t>(std::llround(value * 1e9));
}

/// Splits the pairs into two halves: by frames, or by blocks where there is one frame.
std::array<std::vector<RayPair>, 2> halves(const std::vector<std::vector<RayPair>>& frames) {
    std::array<std::vector<RayPair>, 2> parts;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        for (const RayPair& pair : frames[i]) {
            const int block = pair.block % blocks_across + pair.block / blocks_across;
            parts[frames.size() > 1 ? i % 2 : static_cast<std::size_t>(block % 2)].push_back(pair);
        }
    }
    return parts;
}

std::vector<double> errors(const std::vector<RayPair>& pairs, const VerticalError& error) {
    std::vector<double> values;
    values.reserve(pairs.size());
    for (const RayPair& pair : pairs) {
        values.push_back(error(pair));
    }
    return values;
}

double median_size(std::vector<double> values) {
    for (double& value : values) {
        value = std::abs(value);
    }
    return median(values);
}

std::string text(const char* format, double first, double second) {
    std::array<char, 200> line{};
    std::snprintf(line.data(), line.size(), format, first, second);
    return line.data();
}

}  // namespace

int rows_searched(double f) {
    constexpr double rows_of_focal_length = 0.012;  // 0.7 degrees of pitch
    return std::max(4, static_cast<int>(std::lround(rows_of_focal_length * f)));
}

SelfCalibration::SelfCalibration(StereoCalibration factory) : factory_(std::move(factory)) {
    if (factory_.rectified) {
        throw std::invalid_argument("self-calibration: calibration " + factory_.origin +
                                    " says that the images are rectified already: there is nothing to correct");
    }
}

void SelfCalibration::add(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right, const Rectification& used,
                          const CalibrationCorrection& already, DisparityRange range,
                          const std::atomic<bool>* give_up) {
    f_ = used.f;
    half_width_ = 0.5 * used.width;
    const double grown = 1 + already.focal_ppb * 1e-9;
    std::vector<RayPair> pairs;
    for (const CornerMatch& match : match_corners(left, right, range, rows_searched(used.f), give_up)) {
        const cv::Vec2d from_left =
            direction(used.left_rotation, (match.left_x - used.cx) / f_, (match.left_y - used.cy) / f_);
        const cv::Vec2d from_right =
            direction(used.right_rotation, (match.right_x - used.cx) / f_, (match.right_y - used.cy) / f_);
        const int column = static_cast<int>(match.left_x) * blocks_across / used.width;
        const int row = static_cast<int>(match.left_y) * blocks_down / used.height;
        pairs.push_back(
            {from_left[0], from_left[1], from_right[0] * grown, from_right[1] * grown, row * blocks_across + column});
    }
    frames_.push_back(std::move(pairs));
}

int SelfCalibration::matches() const {
    std::size_t count = 0;
    for (const auto& frame : frames_) {
        count += frame.size();
    }
    return static_cast<int>(count);
}

namespace {

/// Returns which parameters keep the factory's value. Yaw and focal length move every disparity: each changes only when
/// its deviation is worth less than 0.05 px.
std::array<bool, parameters> kept_fixed(const EpipolarFit& fit, double f, double half_width) {
    std::array<bool, parameters> fixed{};
    fixed[yaw] = !(fit.deviation[yaw] * f < largest_disparity_deviation);
    fixed[focal] = !(fit.deviation[focal] * half_width < largest_disparity_deviation);
    return fixed;
}

Parameters taken_over(const EpipolarFit& fit, const std::array<bool, parameters>& fixed) {
    Parameters change = fit.change;
    for (std::size_t i = 0; i < change.size(); ++i) {
        change[i] = fixed[i] ? 0 : change[i];
    }
    return change;
}

Parameters as_change(const CalibrationCorrection& correction) {
    return {correction.pitch_nrad * 1e-9, correction.yaw_nrad * 1e-9, correction.roll_nrad * 1e-9,
            correction.focal_ppb * 1e-9};
}

/// Returns why a fit is not good enough; empty when it is.
std::string shortcoming(const EpipolarFit& fit, double f, double half_width) {
    if (!fit.solved || fit.blocks_used < least_blocks) {
        return text("matches in %.0f parts of the image, %.0f are needed", fit.blocks_used, least_blocks);
    }
    if (fit.inliers < least_inliers) {
        return text("only %.0f %% of the matches agree, %.0f %% are needed", 100 * fit.inliers, 100 * least_inliers);
    }
    if (fit.deviation[pitch] * f > largest_pitch_deviation) {
        return text("pitch is only known to %.3f px, %.3f px are needed", fit.deviation[pitch] * f,
                    largest_pitch_deviation);
    }
    if (fit.deviation[roll] * half_width > largest_roll_deviation) {
        return text("roll is only known to %.3f px, %.3f px are needed", fit.deviation[roll] * half_width,
                    largest_roll_deviation);
    }
    if (std::max(std::abs(fit.change[pitch]), std::abs(fit.change[roll])) > largest_turn) {
        return "the cameras would have turned by more than 1.5 degrees: the calibration is of another camera or mode";
    }
    return {};
}

}  // namespace

SelfCalibrationResult SelfCalibration::solve(const CalibrationCorrection& in_use) const {
    SelfCalibrationResult result;
    result.frames = frames();
    result.matches = matches();
    if (result.matches < least_matches) {
        result.reason = text("%.0f matches, %.0f are needed", result.matches, least_matches);
        return result;
    }
    std::vector<RayPair> all;
    for (const auto& frame : frames_) {
        all.insert(all.end(), frame.begin(), frame.end());
    }
    const EpipolarFit fit = fit_epipolar(factory_, f_, all, blocks);
    const auto fixed = kept_fixed(fit, f_, half_width_);
    result.change = fit.change;
    result.deviation = fit.deviation;
    const auto before = errors(all, VerticalError(factory_, f_, {}));
    result.offset_before = median(before);
    result.error_before = median_size(before);
    result.reason = shortcoming(fit, f_, half_width_);
    if (!result.reason.empty()) {
        return result;
    }
    // Each half tests the correction of the other one.
    const auto parts = halves(frames_);
    std::vector<double> unseen;
    for (std::size_t i = 0; i < 2; ++i) {
        const EpipolarFit half = fit_epipolar(factory_, f_, parts[i], blocks);
        const VerticalError corrected(factory_, f_, taken_over(half, fixed));
        const auto after = errors(parts[1 - i], corrected);
        const double now = median_size(errors(parts[1 - i], VerticalError(factory_, f_, as_change(in_use))));
        if (!half.solved || median_size(after) > now - least_gain) {
            result.reason = text("the correction in use is as good on unseen matches: %.3f px, a new one %.3f px", now,
                                 median_size(after));
            return result;
        }
        unseen.insert(unseen.end(), after.begin(), after.end());
    }
    const Parameters change = taken_over(fit, fixed);
    result.correction = {billionths(change[pitch]), billionths(change[yaw]), billionths(change[roll]),
                         billionths(change[focal])};
    result.error_after = median_size(unseen);
    result.offset_after = median(errors(all, VerticalError(factory_, f_, change)));
    result.accepted = true;
    result.reason = text("vertical error %.3f px, corrected %.3f px on matches that the fit has not seen",
                         result.error_before, result.error_after);
    return result;
}

}  // namespace disparityd::calibration
