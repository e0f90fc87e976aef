// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "capture/images/image_sequence.h"

namespace disparityd::capture {

/// Returns the pairs of a folder in the layout of EuRoC and TUM-VI: cam0/data.csv and cam1/data.csv, in it or in its
/// mav0, name the images with their times in ns. Pairs are those with equal times; images of one eye only, and those
/// that are not there, are left out and counted in `unpaired`. The calibration is sensor.yaml of both cameras and of
/// imu0, else dso/camchain.yaml and dso/imu_config.yaml beside mav0. Samples are those of imu0/data.csv. Nothing for
/// other folders. Throws std::invalid_argument with one line for a damaged data.csv, and where no pair is left.
std::optional<ImageSequence> find_euroc(const std::string& folder);

}  // namespace disparityd::capture
