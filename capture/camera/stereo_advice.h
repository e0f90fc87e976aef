// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

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

/// The same of two cameras that look like one eye each.
struct PairAdvice {
    StereoAdvice advice;
    std::size_t left = 0;  ///< index of a survey. Nobody knows which is which: the one with the first node
    std::size_t right = 0;
};

/// Returns the cameras of which there are two alike on one bus, and no third one: with one name, one USB identity and a
/// mode in common, and each without the looks of a stereo camera. By its USB port each is named, else by its node.
std::vector<PairAdvice> advise_pairs(const std::vector<CameraSurvey>& surveys);

}  // namespace disparityd::capture
