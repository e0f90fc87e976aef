// SPDX-License-Identifier: Apache-2.0
//
// Exposure and gain of a ZED's two eyes, as controls with names.
#pragma once

#include "capture/camera/camera_controls.h"
#include "capture/camera/zed_extension.h"

namespace disparityd::capture {

/// "auto-exposure" (of both eyes, gain included), "exposure-left" and "-right" in lines, "gain-left" and "-right" as
/// the sensor counts it, at this frame rate. Throws ZedError.
std::vector<CameraControl> read_zed_controls(ZedUnit& unit, double rate);

/// Whether `setting` is one of them; throws std::invalid_argument when its value is not allowed.
bool is_zed_control(const CameraSetting& setting, double rate);

/// Throws ZedError. The setting must be allowed.
void set_zed_control(ZedUnit& unit, const CameraSetting& setting);

/// Returns the most lines of exposure at a frame rate.
int longest_exposure(double rate);

/// Whether the sensor takes this gain: its register has gaps between four zones.
bool is_zed_gain(std::int64_t gain);

}  // namespace disparityd::capture
