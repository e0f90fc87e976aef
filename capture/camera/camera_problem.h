// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "capture/camera/camera_uri.h"
#include "capture/camera/video_stream.h"
#include "capture/source_condition.h"

namespace disparityd::capture {

/// What keeps a camera from being used, and the line that tells people what to do.
struct CameraProblem {
    CameraState state = CameraState::absent;
    std::string detail;
};

/// Finds what can be seen without opening the camera: old firmware, no node, a link too slow for a ZED mode. Returns
/// nullopt when there is none of these.
std::optional<CameraProblem> diagnose(const UsbCamera& camera, const CameraRequest& request);

/// Says what a refusal of the system means; `label` names the camera.
CameraProblem diagnose(const VideoError& error, const UsbCamera& camera, const std::string& label);

/// The problem that no camera is what was asked for; `present` are those that are there.
CameraProblem absent_problem(const CameraRequest& request, const std::vector<UsbCamera>& present);

/// The problem that these folders hold no calibration, and there has to be one.
CameraProblem no_calibration_problem(const UsbCamera& camera, const std::vector<std::string>& folders);

/// Lists what the user should know although the camera works: autosuspend, a USB 2 link. Empty when all is well.
std::vector<std::string> camera_notices(const UsbCamera& camera);

/// Writes bcdDevice as "1.42"; empty for 0.
std::string firmware_text(std::uint16_t firmware);

}  // namespace disparityd::capture
