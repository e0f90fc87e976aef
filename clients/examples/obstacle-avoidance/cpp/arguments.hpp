// SPDX-License-Identifier: Apache-2.0
//
// Reads the command line of the example.
#pragma once

#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>

#include "decision.hpp"

namespace avoid {

inline constexpr const char* help =
    R"(Says how fast a robot may drive straight ahead, and brakes when it does not know.

obstacle-avoidance-cpp [OPTION...] [NAME | tcp:HOST:PORT | tls:HOST:PORT | unix:PATH]

Reads obstacle scans of disparityd: of the daemon NAME ("default") of this machine, or from a socket.
Prints a line for each change of state.

  --width-m M             width of the corridor (0.5)
  --margin-m M            the robot stands still this far before an obstacle, counted from the scan's origin (0.5)
  --smallest-m M          width of the smallest obstacle that may hide where nothing is known (0.1)
  --speed-mps V           speed on a free way (1.0)
  --deceleration-mps2 A   of a full brake (1.0)
  --reaction-s S          from a decision until the brakes work (0.2)
  --max-age-ms MS         brake when the newest frame is older (250)
  --good-frames N         so many in a row end a brake (3)
  --camera-height-m M     brake where the floor shows another height of the camera; 0: any (0)
  --camera-pitch-deg A    the same of its pitch, where the height is told (0)
  --synthetic             accept frames that no camera saw: for tests
  --json                  print a line of JSON for each frame, and whenever none came
  --help                  print this text
)";

struct Arguments {
    Options options;
    std::string source = "default";
    bool json = false;
};

/// An option with a value, and what is allowed.
struct NumberOption {
    const char* name;
    double least, most;
    std::function<void(Options&, double)> set;
    bool whole = false;
};

inline const std::array<NumberOption, 10>& number_options() {
    static const std::array<NumberOption, 10> all{{
        {"--width-m", 0.01, 10, [](Options& options, double value) { options.width_m = value; }},
        {"--margin-m", 0.05, 10, [](Options& options, double value) { options.margin_m = value; }},
        {"--smallest-m", 0, 1, [](Options& options, double value) { options.smallest_m = value; }},
        {"--speed-mps", 0.05, 20, [](Options& options, double value) { options.speed_mps = value; }},
        {"--deceleration-mps2", 0.05, 20, [](Options& options, double value) { options.deceleration_mps2 = value; }},
        {"--reaction-s", 0, 10, [](Options& options, double value) { options.reaction_s = value; }},
        {"--max-age-ms", 10, 10000, [](Options& options, double value) { options.max_age_s = value / 1000; }},
        {"--good-frames", 1, 1000,
         [](Options& options, double value) { options.good_frames = static_cast<int>(value); }, true},
        {"--camera-height-m", 0, 100, [](Options& options, double value) { options.camera_height_m = value; }},
        {"--camera-pitch-deg", -45, 45, [](Options& options, double value) { options.camera_pitch_deg = value; }},
    }};
    return all;
}

inline void set_number(Options& options, const NumberOption& option, const std::string& found) {
    char* end = nullptr;
    const double value = std::strtod(found.c_str(), &end);
    const bool number = !found.empty() && *end == '\0' && value >= option.least && value <= option.most;
    if (!number || (option.whole && value != std::floor(value))) {
        throw std::invalid_argument(std::string(option.name) + ": found \"" + found +
                                    "\", allowed: " + (option.whole ? "whole numbers " : "") +
                                    text("%g", option.least) + " .. " + text("%g", option.most));
    }
    option.set(options, value);
}

/// Returns nothing when the help is asked for. Throws std::invalid_argument with one line.
inline std::optional<Arguments> parse(int argc, char** argv) {
    Arguments arguments;
    bool named = false;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const auto option = std::find_if(number_options().begin(), number_options().end(),
                                         [&word](const NumberOption& known) { return word == known.name; });
        if (word == "--help") {
            return std::nullopt;
        }
        if (option != number_options().end()) {
            if (++i == argc) {
                throw std::invalid_argument(word + ": a number must follow");
            }
            set_number(arguments.options, *option, argv[i]);
        } else if (word == "--json") {
            arguments.json = true;
        } else if (word == "--synthetic") {
            arguments.options.synthetic = true;
        } else if (word.starts_with("-")) {
            throw std::invalid_argument(word + ": there is no such option; --help names all");
        } else if (named) {
            throw std::invalid_argument(word + ": one source is allowed, " + arguments.source + " is named already");
        } else if (word.empty() || (word.find('/') != std::string::npos && word.find(':') == std::string::npos)) {
            throw std::invalid_argument("source: found \"" + word +
                                        "\", allowed: the name of a daemon, unix:PATH, tcp:HOST:PORT, tls:HOST:PORT");
        } else {
            arguments.source = word;
            named = true;
        }
    }
    return arguments;
}

}  // namespace avoid
