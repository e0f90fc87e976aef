// SPDX-License-Identifier: Apache-2.0
//
// What the user types: a configuration in TOML, or a single word such as a source, an override or controls of a camera.
#include "capture/camera/camera_controls.h"
#include "capture/camera/camera_uri.h"
#include "capture/scene/scene_options.h"
#include "daemon/config/config.h"
#include "tests/fuzz/outcome.h"

using namespace disparityd;

namespace {

void read_source(const std::string& uri) {
    // A source with the name as it was typed: it is the user's own line.
    const std::string begin = "source ";
    if (capture::is_camera(uri)) {
        fuzz::accepted(begin, [&] {
            const capture::CameraRequest request = capture::parse_camera_uri(uri);
            fuzz::expect(request.eye_width() >= 8 && request.eye_height() >= 8, "an eye without pixels");
        });
    } else if (uri.starts_with("scene:")) {
        fuzz::accepted(begin, [&] {
            const capture::SceneOptions options = capture::parse_scene_uri(uri);
            fuzz::expect(options.width >= 16 && options.height >= 8 && options.loop >= 1, "a scene without pixels");
        });
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text(fuzz::text_of(data, size));
    constexpr std::string_view set = "--set ";
    constexpr std::string_view controls = "controls ";
    if (text.starts_with(set)) {
        const std::string word = text.substr(set.size());
        fuzz::accepted("--set ", [&] { daemon::parse_config("", "file", {daemon::parse_override(word)}); });
    } else if (text.starts_with(controls)) {
        fuzz::accepted("where: ", [&] { capture::parse_camera_settings(text.substr(controls.size()), "where"); });
    } else if (text.starts_with("v4l2:") || text.starts_with("scene:")) {
        read_source(text);
    } else {
        fuzz::accepted("file", [&] { read_source(daemon::parse_config(text, "file").source.uri); });
    }
    return 0;
}
