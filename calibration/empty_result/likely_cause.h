// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "calibration/calibration.h"
#include "kernels/image.h"
#include "kernels/options.h"

namespace disparityd::empty_result {

/// Why hardly anything of a pair could be measured.
enum class Cause : unsigned char { unknown, other_resolution, no_texture, rows, eyes_exchanged, range, turned };

struct LikelyCause {
    Cause cause = Cause::unknown;
    std::string text;  ///< for people, one sentence without a full stop: what was found, what to do
};

/// A rectified pair that was matched, and with what.
struct Suspect {
    Plane<const std::uint8_t> left;
    Plane<const std::uint8_t> right;
    DisparityRange range;
    std::optional<calibration::StereoCalibration> calibration;  ///< that it was rectified by
};

/// The test for a calibration of another resolution alone: it needs no pictures, and a result that is not empty may
/// be wrong for this cause. Nothing where it fits or is not known.
std::optional<LikelyCause> other_resolution(const std::optional<calibration::StereoCalibration>& calibration);

/// Tests for each cause in turn and names the first that holds: a calibration of another resolution, no texture, rows
/// that are not aligned, eyes exchanged, a range that does not reach, one image upside down or mirrored. Some 0.2 s,
/// 0.6 s where the last is tested. The caller knows that little was
/// measured: of a good pair no cause holds.
LikelyCause likely_cause(const Suspect& suspect);

}  // namespace disparityd::empty_result
