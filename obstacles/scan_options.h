// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "proto/scan.h"

namespace disparityd {

/// Where the ground's plane comes from.
enum class GroundMode : std::uint8_t {
    configured,  ///< the plane z = 0 of the mounting
    fitted,      ///< fitted to each frame, near the configured one
    gravity,     ///< level: at right angles to the gravity that the camera's inertial sensor measures
    autopilot,   ///< level, as an autopilot tells it; without that, nothing is known
};

/// Returns the mode's name as the configuration has it.
std::string_view to_string(GroundMode mode);

/// Returns the mode of a name; nothing for another word.
std::optional<GroundMode> parse_ground_mode(std::string_view name);

/// The names of all modes for a message: "fitted, configured, gravity or autopilot".
inline constexpr std::string_view ground_mode_names = "fitted, configured, gravity or autopilot";

/// Returns the default of `min_confidence`: four fifths where the confidence is a chance, else 1, which leaves the
/// matcher's own rejection to decide (a ratio of costs says nothing about the chance).
constexpr int default_min_confidence(bool calibrated) {
    return calibrated ? 200 : 1;
}

/// How an obstacle scan is made: step 14 of docs/algorithm.md. Angles in degrees, lengths in metres.
struct ScanOptions {
    int sectors = 72;  ///< 1 .. max_scan_sectors
    /// The bearings of the right-most and of the left-most edge, left positive; both 0: the field of view.
    double from_deg = 0;
    double to_deg = 0;

    // The mounting of the left camera on the robot, whose x axis points ahead, y left, z up.
    double camera_height_m = 0.3;  ///< above the ground; more than low_m
    double pitch_deg = 0;          ///< positive: looks down; -45 .. 45
    double roll_deg = 0;           ///< positive: its right side is lower; -45 .. 45
    double yaw_deg = 0;            ///< positive: looks left; -180 .. 180
    /// Height, pitch and roll are those that the floor in view shows; until one was seen, nothing is known.
    bool find_mounting = false;
    // Bearings and distances are counted from the robot's origin, which the camera is so far ahead and left of.
    double camera_ahead_m = 0;
    double camera_left_m = 0;

    GroundMode ground = GroundMode::fitted;
    /// Where the x, y and z axes of the inertial sensor point (obstacles/gravity_ground.h); GroundMode::gravity
    /// needs it. Empty: not known.
    std::string imu_axes;
    double low_m = 0.08;  ///< what is lower above the ground's plane is ground
    double high_m = 1.0;  ///< what is higher is overhead
    double drop_m = 0;    ///< what lies lower than this below the ground ends it, as an obstacle; 0: does not
    double min_m = 0.2;   ///< what is nearer is unknown: a part of the robot, or too near for the range of disparities
    double max_m = 20;    ///< neither obstacles nor freedom are reported beyond

    double object_m = 0.1;            ///< side of the smallest obstacle that counts, and that freedom excludes
    double max_error_m = 1;           ///< a disparity whose one-sigma depth error is larger counts as unknown
    double subpixel_error_px = 0.25;  ///< one sigma of a disparity
    /// Obstacle pixels with less are unsure: they count neither as obstacle nor as seen. 1 .. 255; 200 of a calibrated
    /// confidence are four fifths.
    int min_confidence = default_min_confidence(true);
};

inline constexpr int max_scan_sectors = static_cast<int>(proto::scan_max_sectors);

/// A row of the table of options.
struct ScanField {
    std::string_view name;  ///< as the configuration has it
    std::variant<int ScanOptions::*, double ScanOptions::*, bool ScanOptions::*, GroundMode ScanOptions::*,
                 std::string ScanOptions::*>
        field;
    double min = 0;  ///< of a number
    double max = 0;
};

/// Returns each option once, with the range of its numbers.
std::span<const ScanField> scan_fields();

/// Returns one line about the first option that is out of range, empty when all are allowed.
std::string validate(const ScanOptions& options);

}  // namespace disparityd
