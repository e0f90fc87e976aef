// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "capture/calibration_correction.h"
#include "capture/frame_source.h"

namespace disparityd::calibration {

/// Where the correction of a source's camera and mode is kept in a folder: self-calibration-<serial>-<W>x<H>.txt, with
/// the calibration's identity instead of an unknown serial number.
std::string correction_path(const std::string& folder, const capture::SourceInfo& source);

/// Writes a file of a few lines, whole or not at all. `calibration` is what the correction corrects. Throws
/// std::runtime_error with one line when the system refuses.
void write_correction(const std::string& path, const capture::StereoCalibration& calibration,
                      const capture::CalibrationCorrection& correction);

/// Reads it back; nothing when there is no such file, or when it corrects another calibration than this. Throws
/// std::invalid_argument with one line for a file that is damaged.
std::optional<capture::CalibrationCorrection> read_correction(const std::string& path,
                                                              const capture::StereoCalibration& calibration);

}  // namespace disparityd::calibration
