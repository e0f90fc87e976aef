// SPDX-License-Identifier: Apache-2.0
#include "capture/scene/scene_options.h"

#include <algorithm>
#include <array>

#include "base/words.h"
#include "calibration/zed_modes.h"
#include "capture/source_uri.h"

namespace disparityd::capture {

namespace {

constexpr std::size_t memory_limit = std::size_t{192} << 20U;
constexpr int longest_loop = 32;

void read_parameter(const SourceUri& reader, const SourceUri::Parameter& parameter, SceneOptions& options) {
    const std::string key(parameter.key);
    const std::string_view value = parameter.value;
    if (key == "frames") {
        options.frames = static_cast<std::uint64_t>(reader.integer(key, value, 1, 1'000'000'000));
    } else if (key == "seed") {
        options.seed = static_cast<std::uint32_t>(reader.integer(key, value, 0, 1'000'000'000));
    } else if (key == "loop") {
        options.loop = reader.integer(key, value, 1, 1000);
    } else if (key == "width") {
        options.width = reader.integer(key, value, 16, 4096);
        if (options.width % 2 != 0) {
            reader.fail(key, value, "an even number: YUYV has pairs of pixels");
        }
    } else if (key == "height") {
        options.height = reader.integer(key, value, 8, 4096);
    } else {
        reader.fail("parameter", key, "frames, seed, loop, width or height");
    }
}

}  // namespace

SceneOptions parse_scene_uri(const std::string& uri) {
    const SourceUri reader(uri);
    const std::string name = reader.name().empty() ? "vga" : base::lower_case(reader.name());
    const calibration::ZedMode* mode = calibration::zed_mode_of_name(name);
    if (mode == nullptr) {
        reader.fail("mode", reader.name(), "vga, hd720, hd1080 or hd2k");
    }
    SceneOptions options;
    options.width = mode->width;
    options.height = mode->height;
    options.rate = reader.has_rate() ? reader.number("rate", reader.rate(), 0.1, 1000) : mode->highest_rate;
    for (const SourceUri::Parameter& parameter : reader.parameters()) {
        read_parameter(reader, parameter, options);
    }
    const std::size_t frame_bytes =
        static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height) * 4;
    const int affordable = std::max(2, static_cast<int>(memory_limit / frame_bytes));
    if (options.loop == 0) {
        // Larger pictures take longer: about the same time for each mode.
        constexpr std::size_t enough = std::size_t{4 * 672 * 376} * longest_loop;
        options.loop = std::clamp(static_cast<int>(enough / frame_bytes), 4, longest_loop);
    }
    if (options.loop > affordable) {
        reader.fail("loop", std::to_string(options.loop),
                    "1 to " + std::to_string(affordable) + " at this size: the frames are kept in memory");
    }
    if (options.frames) {
        options.loop =
            static_cast<int>(std::min<std::uint64_t>(static_cast<std::uint64_t>(options.loop), *options.frames));
    }
    return options;
}

}  // namespace disparityd::capture
