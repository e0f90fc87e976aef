// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "capture/camera/camera_uri.h"
#include "capture/camera/video_system.h"
#include "capture/frame_source.h"

namespace disparityd::capture {

/// Two cameras that are the two eyes. Each is opened, controlled and recovered as a single one is. Frames whose
/// drivers' stamps are at most request.within_ns apart are a pair: they are copied side by side, have the left one's
/// stamps, and numbers of their own. A frame that finds no partner is counted as unpaired, and its pair as lost. The
/// calibration is that of the two serial numbers with a hyphen between, left first. `system` must outlive the source.
/// Throws as open_camera().
std::unique_ptr<FrameSource> open_camera_pair(VideoSystem& system, const SourceOptions& options,
                                              const CameraRequest& request);

}  // namespace disparityd::capture
