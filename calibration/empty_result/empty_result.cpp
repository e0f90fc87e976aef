// SPDX-License-Identifier: Apache-2.0
#include "calibration/empty_result/empty_result.h"

#include <algorithm>

#include "base/number_text.h"

namespace disparityd::empty_result {
namespace {

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
