// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/camera_pair.h"
#include "capture/camera/camera_source.h"

namespace disparityd::capture {

std::unique_ptr<FrameSource> open_camera_on(VideoSystem& system, const SourceOptions& options, SensorSystem* sensors) {
    const CameraRequest request = parse_camera_uri(options.uri);
    return request.right ? open_camera_pair(system, options, request)
                         : open_single_camera(system, options, request, sensors);
}

std::unique_ptr<FrameSource> open_camera(const SourceOptions& options) {
    return open_camera_on(linux_video_system(), options, &linux_sensor_system());
}

}  // namespace disparityd::capture
