// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "capture/recording/recording_ffmpeg.h"

namespace disparityd::capture {

/// What a video says about how its pictures are to be shown.
struct VideoLayout {
    bool side_by_side = false;           ///< it declares both eyes side by side, the left one in the left half
    std::optional<std::string> refusal;  ///< why its pictures cannot be taken as they are stored, and what to do
};

/// Reads what the container declares for a stream: a rotation, and a stereo layout.
VideoLayout layout_of(const AVStream& stream);

/// Reads what the codec declares in the video itself.
VideoLayout layout_of(const AVFrame& frame);

}  // namespace disparityd::capture
