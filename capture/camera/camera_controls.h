// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "capture/camera/video_system.h"
#include "capture/camera_setting.h"

namespace disparityd::capture {

/// "gain-left=30 auto-exposure=0"; `where` is for messages. Throws std::invalid_argument.
std::vector<CameraSetting> parse_camera_settings(const std::string& text, const std::string& where);

/// Sets controls in this order, then reads all: those of V4L2 and, of a ZED, those behind its extension unit
/// ("auto-exposure", "exposure-left", "exposure-right", "gain-left", "gain-right"; exposure in lines, gain as the
/// sensor counts it). Opens the node by itself: a stream of somebody else goes on. Nothing is set when a name is not
/// known or a value out of range. Throws std::invalid_argument for those, std::runtime_error when the camera refuses.
std::vector<CameraControl> control_camera(VideoSystem& system, const UsbCamera& camera, double rate,
                                          const std::vector<CameraSetting>& settings);

}  // namespace disparityd::capture
