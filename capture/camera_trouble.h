// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "capture/camera_uri.h"
#include "capture/source_condition.h"
#include "capture/video_stream.h"

namespace disparityd::capture {

/// What keeps a camera from being used, and the line that tells people what to do.
struct CameraTrouble {
    CameraState state = CameraState::absent;
    std::string detail;
};

/// What is known without opening the camera: old firmware, no node, a link too slow for a ZED mode. nullopt: nothing.
std::optional<CameraTrouble> trouble_at_sight(const UsbCamera& camera, const CameraRequest& request);

/// What a refusal of the system means; `label` names the camera.
CameraTrouble trouble_of(const VideoError& error, const UsbCamera& camera, const std::string& label);

/// No camera is what was asked for; `present` are those that are there.
CameraTrouble absent_trouble(const CameraRequest& request, const std::vector<UsbCamera>& present);

/// No calibration was found in these folders, and there has to be one.
CameraTrouble no_calibration_trouble(const UsbCamera& camera, const std::vector<std::string>& folders);

/// What does not hinder: autosuspend, a USB 2 link. Empty when all is well.
std::vector<std::string> camera_notices(const UsbCamera& camera);

/// "1.42" from bcdDevice; empty for 0.
std::string firmware_text(std::uint16_t firmware);

}  // namespace disparityd::capture
