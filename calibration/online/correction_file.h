// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "calibration/calibration_correction.h"

namespace disparityd::calibration {

/// Returns where the correction of a camera in one mode is kept: FOLDER/self-calibration-<serial>-<W>x<H>.txt.
/// `eye_width` and `height` are pixels of one captured image. An empty `serial` (unknown) is replaced by the identity
/// of `calibration`, the one that is corrected.
std::string correction_path(const std::string& folder, const std::string& serial, int eye_width, int height,
                            const StereoCalibration& calibration);

/// Writes a file of a few lines, whole or not at all. `calibration` is what the correction corrects. Throws
/// std::runtime_error with one line when the system refuses.
void write_correction(const std::string& path, const StereoCalibration& calibration,
                      const CalibrationCorrection& correction);

/// Reads the file. Returns nothing when there is none, or when it corrects another calibration. Throws
/// std::invalid_argument with one line when the file is damaged.
std::optional<CalibrationCorrection> read_correction(const std::string& path, const StereoCalibration& calibration);

}  // namespace disparityd::calibration
