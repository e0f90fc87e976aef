// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "capture/camera/camera_uri.h"
#include "capture/camera/eye_cameras.h"
#include "capture/camera/video_system.h"
#include "capture/frame_source.h"
#include "capture/sensors/sensor_system.h"

namespace disparityd::capture {

/// A live camera through V4L2 ("v4l2:..."), for the table of sources. With SourceOptions::wait_for_camera it opens
/// whether the camera is there or not, and its next() recovers from whatever happens to the camera: condition() says
/// what that is. Without, it throws std::invalid_argument or std::runtime_error when the camera cannot be used now.
std::unique_ptr<FrameSource> open_camera(const SourceOptions& options);

/// The same on another system; `system` and `sensors` must outlive the source. No `sensors`: they are not read.
std::unique_ptr<FrameSource> open_camera_on(VideoSystem& system, const SourceOptions& options,
                                            SensorSystem* sensors = nullptr);

/// The same for one camera that the request names, in place of the one in the URI. It may be of one eye: `eye` then
/// says which cameras are meant; its pair must outlive the source and be used by the same thread.
std::unique_ptr<FrameSource> open_single_camera(VideoSystem& system, const SourceOptions& options,
                                                const CameraRequest& request, SensorSystem* sensors,
                                                const EyeOfPair& eye = {});

}  // namespace disparityd::capture
