// SPDX-License-Identifier: Apache-2.0
#include "capture/frame_source.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

#include "base/message_text.h"
#include "capture/camera_setting.h"
#include "capture/source_condition.h"
#include "capture/time_offset.h"

namespace disparityd::capture {

namespace {

/// Says what a text is that names no source, and what was meant perhaps. The kinds of sources help only whoever has
/// named another kind.
std::string unknown_source(const std::string& uri) {
    std::error_code ignored;
    const std::string found = "source '" + base::printable(uri, 300) + "': ";
    if (std::filesystem::exists(uri, ignored)) {
        return found + "a device or a pipe; expected a file, a folder or a kind of source (disparityctl sources)";
    }
    if (uri.find_first_of("*?[") != std::string::npos) {
        return found + "no such file; of images write the number as %d: left_%d.png,right_%d.png";
    }
    const auto colon = uri.find(':');
    const std::string kind = uri.substr(0, colon);
    const bool is_path = colon == std::string::npos || kind.empty() ||
                         !std::all_of(kind.begin(), kind.end(), [](unsigned char c) { return std::isalnum(c) != 0; });
    if (is_path) {
        const auto comma = uri.find(',');
        return found + "no such file or folder" +
               (comma == std::string::npos ? "" : "; of a pair both must be there, with a comma between") +
               "; disparityctl sources lists the kinds of sources";
    }
    std::string all;
    for (const SourceKind& known : source_kinds()) {
        all += "; " + std::string(known.description);
    }
    return found + "no such file or folder, and no other source; allowed are" + all.substr(1);
}

}  // namespace

SourceCondition FrameSource::condition() const {
    return {};
}

std::vector<CameraControl> FrameSource::set_camera_controls(const std::vector<CameraSetting>&) {
    throw std::invalid_argument("camera: the source " + info().name + " is no camera, allowed: v4l2:");
}

std::unique_ptr<FrameSource> open_source(const SourceOptions& options) {
    for (const SourceKind& kind : source_kinds()) {
        if (kind.accepts(options.uri)) {
            return with_time_offset(kind.open(options), options);
        }
    }
    throw std::invalid_argument(unknown_source(options.uri));
}

}  // namespace disparityd::capture
