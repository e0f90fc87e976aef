// SPDX-License-Identifier: Apache-2.0
#include "capture/scene_options.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "capture/text_file.h"
#include "capture/zed_modes.h"

namespace disparityd::capture {

namespace {

constexpr std::size_t memory_limit = std::size_t{192} << 20U;
constexpr int longest_loop = 32;

class UriReader {
public:
    explicit UriReader(const std::string& uri) : uri_(uri) {}

    [[noreturn]] void fail(const std::string& what, std::string_view found, const std::string& allowed) const {
        throw std::invalid_argument("source " + uri_ + ": " + what + ": found '" + std::string(found) +
                                    "', allowed is " + allowed);
    }

    double number(const std::string& what, std::string_view text, double least, double most) const {
        const auto number = parse_number(text);
        if (!number || *number < least || *number > most) {
            fail(what, text, number_text(least) + " to " + number_text(most));
        }
        return *number;
    }

    int integer(const std::string& what, std::string_view text, int least, int most) const {
        const double value = number(what, text, least, most);
        if (value != static_cast<int>(value)) {
            fail(what, text, "a whole number");
        }
        return static_cast<int>(value);
    }

private:
    const std::string& uri_;
};

void read_parameter(const UriReader& reader, std::string_view parameter, SceneOptions& options) {
    const auto equals = parameter.find('=');
    const std::string key(parameter.substr(0, equals));
    const std::string_view value = equals == std::string_view::npos ? "" : parameter.substr(equals + 1);
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
    const UriReader reader(uri);
    std::string_view rest = std::string_view(uri).substr(uri.find(':') + 1);
    std::string_view parameters;
    if (const auto question = rest.find('?'); question != std::string_view::npos) {
        parameters = rest.substr(question + 1);
        rest = rest.substr(0, question);
    }
    std::string_view rate;
    if (const auto at = rest.find('@'); at != std::string_view::npos) {
        rate = rest.substr(at + 1);
        rest = rest.substr(0, at);
    }
    const std::string name = rest.empty() ? "vga" : lower_case(rest);
    const auto* mode =
        std::find_if(zed_modes.begin(), zed_modes.end(), [&](const ZedMode& m) { return m.name == name; });
    if (mode == zed_modes.end()) {
        reader.fail("mode", rest, "vga, hd720, hd1080 or hd2k");
    }
    SceneOptions options;
    options.width = mode->width;
    options.height = mode->height;
    options.rate = rate.data() == nullptr ? mode->highest_rate : reader.number("rate", rate, 0.1, 1000);
    if (!parameters.empty()) {
        for (const std::string_view parameter : split(parameters, '&')) {
            read_parameter(reader, parameter, options);
        }
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
