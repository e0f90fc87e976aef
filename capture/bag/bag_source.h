// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "capture/frame_source.h"

namespace disparityd::capture {

/// Replays the images of two topics of a ROS bag, or of one with both eyes side by side, with the calibration of
/// their CameraInfo and the samples of an inertial sensor. Threads, pace and loops are those of open_recording().
/// Images without a partner count as lost frames.
///
/// Throws std::invalid_argument when the bag has no such topics or its calibration cannot be used, unless
/// SourceOptions::calibration_path names another; std::runtime_error when it is damaged before the first frame. A bag
/// that was cut off plays what is whole; then next() throws std::runtime_error.
std::unique_ptr<FrameSource> open_bag(const SourceOptions& options);

}  // namespace disparityd::capture
