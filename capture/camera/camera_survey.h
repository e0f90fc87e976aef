// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "capture/camera/video_system.h"

namespace disparityd::capture {

/// A format and size that a camera offers.
struct VideoMode {
    std::string format;  ///< four characters, such as "YUYV"
    int width = 0;       ///< of the whole frame, pixels
    int height = 0;
    std::vector<double> rates;  ///< frames per second, as the driver lists them
};

/// A camera, what it offers, and what keeps it from being used.
struct CameraSurvey {
    UsbCamera camera;
    std::vector<VideoMode> modes;
    std::string problem;               ///< one line that says what to do; empty: it can be used
    std::vector<std::string> notices;  ///< see camera_notices()
};

/// Lists all cameras, ZED cameras with the serial number that they give when they are asked. Opens each camera for a
/// moment and disturbs none that is in use.
std::vector<CameraSurvey> survey_cameras(VideoSystem& system);

}  // namespace disparityd::capture
