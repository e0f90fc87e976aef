// SPDX-License-Identifier: Apache-2.0
#include "capture/frame_source.h"

#include <filesystem>
#include <stdexcept>

#include "capture/camera_setting.h"
#include "capture/source_condition.h"

namespace disparityd::capture {

SourceCondition FrameSource::condition() const {
    return {};
}

std::vector<CameraControl> FrameSource::set_camera_controls(const std::vector<CameraSetting>&) {
    throw std::invalid_argument("camera: the source " + info().name + " is no camera, allowed: v4l2:");
}

std::unique_ptr<FrameSource> open_source(const SourceOptions& options) {
    for (const SourceKind& kind : source_kinds()) {
        if (kind.accepts(options.uri)) {
            return kind.open(options);
        }
    }
    std::error_code ignored;
    const char* what = std::filesystem::exists(options.uri, ignored) ? "a device or a pipe" : "no such file or folder";
    std::string kinds;
    for (const SourceKind& kind : source_kinds()) {
        kinds += "; " + std::string(kind.description);
    }
    throw std::invalid_argument("source '" + options.uri + "': " + what + ", and no other source; allowed are" +
                                kinds.substr(1));
}

}  // namespace disparityd::capture
