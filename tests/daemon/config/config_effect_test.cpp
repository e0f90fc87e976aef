// SPDX-License-Identifier: Apache-2.0
//
// Keys whose fields the daemon hands on as a whole, to the matcher and to the rectification: each changes what comes
// out. tests/house/check_config_keys.py looks for the reading of all others.
#include <algorithm>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calibration/rectification.h"
#include "daemon/config/config.h"
#include "daemon/config/config_keys.h"
#include "kernels/match_fields.h"
#include "kernels/pair_matcher.h"
#include "obstacles/gravity_ground.h"
#include "obstacles/obstacle_scanner.h"

namespace disparityd::daemon {
namespace {

constexpr int width = 160;
constexpr int height = 40;

/// What a user may write for a key, without asking whether it is allowed: the words that the key names, and numbers.
std::vector<std::string> values_to_try(const ConfigKey& key) {
    if (std::holds_alternative<bool>(key.example)) {
        return {"true", "false"};
    }
    if (std::holds_alternative<std::vector<std::int64_t>>(key.example)) {
        return {"[]", "[1, 2, 30, 20]"};
    }
    if (std::holds_alternative<std::int64_t>(key.example)) {
        return {"0", "1", "2", "3", "4", "5", "8", "30", "32", "40", "90", "99", "160"};
    }
    if (std::holds_alternative<double>(key.example)) {
        return {"-30", "-5", "-0.5", "0", "0.05", "0.1", "0.25", "0.4", "0.5", "1", "2", "3", "5", "30"};
    }
    if (key.name == "imu_axes") {
        return {"ahead left up", "back right up", "up down"};
    }
    std::vector<std::string> words;
    for (std::size_t begin = key.allowed.find('"'); begin != std::string::npos;) {
        const std::size_t end = key.allowed.find('"', begin + 1);
        words.push_back(key.allowed.substr(begin + 1, end - begin - 1));
        begin = key.allowed.find('"', end + 1);
    }
    return words;
}

/// The configuration with one key set, or nothing where the value is not allowed. Small regions are removed, so that
/// the step between them counts; the rectified size is set, so that each side may be changed alone; winners need not be
/// unique and regions need no texture, because either would reject what other keys reject. Axes count where the ground
/// is that of gravity, and that noise adapts where frames without a level of their own would have another one.
std::optional<Config> with(const ConfigKey& key, const std::string& value) {
    const Override set{std::string(key.section), std::string(key.name), value, "--set"};
    try {
        std::string text = "[match]\nspeckle_size = 30\nmin_texture = 0\nuniqueness = 0\n";
        text += "[rectify]\nwidth = 48\nheight = 36\n";
        text += key.name == "imu_axes" ? "[scan]\nground = \"gravity\"\nimu_axes = \"right down ahead\"\n" : "";
        return parse_config(text, "test.toml", {set});
    } catch (const std::invalid_argument&) {
        return std::nullopt;
    }
}

/// A noisy pair: what the left image shows lies 5 to 19 px further left in the right one, or nowhere.
struct NoisyPair {
    std::vector<std::uint8_t> left = std::vector<std::uint8_t>(width * height);
    std::vector<std::uint8_t> right = std::vector<std::uint8_t>(width * height);

    NoisyPair() {
        std::mt19937 random(7);
        for (std::uint8_t& pixel : left) {
            pixel = static_cast<std::uint8_t>(random() % 256);
        }
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const int shift = 5 + x / 32 * 3 + y / 16;
                const bool seen = x + shift < width && random() % 8 != 0;
                const int value = seen ? left[static_cast<std::size_t>(y * width + x + shift)] : 128;
                right[static_cast<std::size_t>(y * width + x)] =
                    static_cast<std::uint8_t>(std::clamp(value + static_cast<int>(random() % 25) - 12, 0, 255));
            }
        }
    }
};

using Planes = std::tuple<std::vector<std::int16_t>, std::vector<std::uint8_t>>;

Planes matched(const std::vector<std::uint8_t>& left, const std::vector<std::uint8_t>& right,
               const MatchOptions& options, int columns, int rows) {
    const auto pixels = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
    Planes planes{std::vector<std::int16_t>(pixels), std::vector<std::uint8_t>(pixels)};
    PairResults results;
    results.disparity = {std::get<0>(planes).data(), columns, rows, columns};
    results.confidence = {std::get<1>(planes).data(), columns, rows, columns};
    PairMatcher matcher(columns, rows, options, "cpu");
    Serial one_thread;
    matcher.match({left.data(), columns, rows, columns}, {right.data(), columns, rows, columns}, results, one_thread);
    return planes;
}

/// Of the noisy pair seen with so few candidates that a part of it is nearer, each pixel four times as wide and high.
Planes matched_too_near(const NoisyPair& noisy, MatchOptions options) {
    constexpr int times = 4;
    std::vector<std::uint8_t> left(times * times * width * height), right(left.size());
    for (std::size_t i = 0; i < left.size(); ++i) {
        const std::size_t x = i % (times * width) / times, y = i / (times * width) / times;
        left[i] = noisy.left[y * width + x];
        right[i] = noisy.right[y * width + x];
    }
    options.range.count = 16;
    return matched(left, right, options, times * width, times * height);
}

/// Of a noisy pair, also when it is too near, and of a grey one without SGM: no candidate is better than another there,
/// while the paths of SGM would carry what they see at the left border through the whole image.
std::tuple<Planes, Planes, Planes> matched(const MatchOptions& options) {
    static const NoisyPair noisy;
    static const std::vector<std::uint8_t> grey(width * height, 90);
    MatchOptions alone = options;
    alone.method = Method::census;
    return {matched(noisy.left, noisy.right, options, width, height), matched_too_near(noisy, options),
            matched(grey, grey, alone, width, height)};
}

/// What a client sees of the geometry: size, and the principal point within the region.
std::tuple<int, int, double, double> rectified(const Config& config) {
    const calibration::CameraModel camera{.fx = 40, .fy = 40, .cx = 32, .cy = 24, .distortion = {}};
    calibration::StereoCalibration calibration;
    calibration.width = 64;
    calibration.height = 48;
    calibration.left = calibration.right = camera;
    calibration.translation = {-120, 0, 0};
    const auto made = calibration::make_rectification(calibration, 64, 48, config.rectify.geometry);
    return {made.width, made.height, made.cx, made.cy};
}

/// Whether two allowed values of a key give different results.
template <typename Compute>
bool has_effect(const ConfigKey& key, const Compute& compute) {
    std::optional<decltype(compute(Config()))> first;
    for (const std::string& value : values_to_try(key)) {
        if (const std::optional<Config> config = with(key, value)) {
            const auto result = compute(*config);
            if (first && *first != result) {
                return true;
            }
            first = first ? first : result;
        }
    }
    return false;
}

TEST(ConfigEffect, EveryOptionOfTheMatcherChangesItsResult) {
    int keys = 0;
    for (const ConfigKey& key : config_keys()) {
        const auto rows = match_fields();
        const bool of_matcher =
            key.name == "preset" || key.name == "method" || key.name == "cost" ||
            std::any_of(rows.begin(), rows.end(), [&key](const MatchField& row) { return row.name == key.name; });
        if (key.section == "match" && of_matcher) {
            EXPECT_TRUE(has_effect(key, [&](const Config& config) { return matched(config.match.options); }))
                << full_name(key) << " changes nothing";
            ++keys;
        }
    }
    EXPECT_GE(keys, 15);
}

TEST(ConfigEffect, EveryKeyOfTheGeometryChangesIt) {
    int keys = 0;
    for (const ConfigKey& key : config_keys()) {
        // The others choose products of a frame, not its geometry.
        const bool of_geometry = key.name != "colour" && key.name != "right" && key.name != "raw";
        if (key.section == "rectify" && of_geometry) {
            EXPECT_TRUE(has_effect(key, rectified)) << full_name(key) << " changes nothing";
            ++keys;
        }
    }
    EXPECT_GE(keys, 3);
}

/// The scan of a floor 0.3 m below the camera with a step of 0.04 m, a post on it and a step down, and a hole in the
/// image.
std::vector<ScanSector> scanned(const Config& config) {
    constexpr int rows = 120;
    const scan::Camera camera{width, rows, 100, 80, 60, {16 * 100 * 120, 0}};
    std::vector<std::int16_t> disparity(width * rows);
    std::vector<std::uint8_t> confidence(width * rows);
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < width; ++x) {
            const bool post = x > 60 && x < 72 && y < 80;
            const double down = (y - 60) / 100.0;
            const bool low = x > 130 && down < 300.0 / 700;
            const double floor = low ? 600.0 : x > 110 ? 300.0 - 40 : 300.0;
            const double z = post ? 1500 : down > 0 ? std::min(floor / down, 12000.0) : 3000;
            const std::size_t i = static_cast<std::size_t>(y * width + x);
            disparity[i] = static_cast<std::int16_t>(16 * 100 * 120 / z);
            confidence[i] = x > 20 && x < 32 && y > 50 && y < 62 ? 0 : x > 85 ? 200 : 50;
        }
    }
    ObstacleScanner scanner(width, rows, config.scan.options, fastest_frame_steps());
    Scan scan = scanner.empty_scan();
    const auto axes = scan::parse_sensor_axes(config.scan.options.imu_axes);
    const auto up = axes ? std::optional(axes->turned({0.17, 0.05, 0.98})) : std::nullopt;
    scanner.scan({{disparity.data(), width, rows, width}, {confidence.data(), width, rows, width}}, camera, scan, up);
    return scan.sectors;
}

TEST(ConfigEffect, EveryKeyOfTheScanChangesIt) {
    int keys = 0;
    for (const ConfigKey& key : config_keys()) {
        if (key.section == "scan" && key.name != "enabled") {
            EXPECT_TRUE(has_effect(key, scanned)) << full_name(key) << " changes nothing";
            ++keys;
        }
    }
    EXPECT_EQ(keys, 20);
}

TEST(ConfigEffect, AKeyWithoutEffectIsFound) {
    const auto census = [&](const Config& config) {
        MatchOptions options = config.match.options;
        options.method = Method::census;
        return matched(options);
    };
    for (const ConfigKey& key : config_keys()) {
        if (key.section == "match" && (key.name == "p1" || key.name == "adaptive_p2")) {
            EXPECT_FALSE(has_effect(key, census)) << full_name(key);
        }
    }
}

}  // namespace
}  // namespace disparityd::daemon
