// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "capture/camera/camera_survey.h"

namespace disparityd::capture {

/// Why a camera looks like two eyes, and how to start with it.
struct StereoAdvice {
    std::string reason;  ///< "a ZED 2", "2560x720 is two pictures of 16:9 side by side"
    std::string uri;     ///< names the camera by its serial number, else by its USB port, else by its node
    int eye_width = 0;   ///< of that mode, pixels
    int eye_height = 0;
};

/// Returns nothing for a camera that does not look like a stereo pair, or cannot be used: its size tells no eyes one
/// above the other from a picture that is tall. Of several modes it takes the largest up to 1280x960 for an eye that
/// comes at 24 frames/s or more, without JPEG where both reach that.
std::optional<StereoAdvice> advise(const CameraSurvey& survey);

}  // namespace disparityd::capture
