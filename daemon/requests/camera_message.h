// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "capture/camera/camera_controls.h"
#include "capture/source_condition.h"
#include "proto/disparity.pb.h"

namespace disparityd::daemon {

/// The camera as clients see it.
v1::CameraStatus to_message(const capture::CameraFacts& camera);

v1::CameraControls to_message(const std::vector<capture::CameraControl>& controls);
std::vector<capture::CameraSetting> to_settings(const v1::CameraRequest& request);

}  // namespace disparityd::daemon
