// SPDX-License-Identifier: Apache-2.0
#include "obstacles/scan_options.h"

#include <array>
#include <cmath>
#include <sstream>

#include "obstacles/gravity_ground.h"

namespace disparityd {
namespace {

constexpr std::array fields{
    ScanField{"sectors", &ScanOptions::sectors, 1, max_scan_sectors},
    ScanField{"from_deg", &ScanOptions::from_deg, -180, 180},
    ScanField{"to_deg", &ScanOptions::to_deg, -180, 180},
    ScanField{"camera_height_m", &ScanOptions::camera_height_m, -10, 30},
    ScanField{"pitch_deg", &ScanOptions::pitch_deg, -45, 45},
    ScanField{"roll_deg", &ScanOptions::roll_deg, -45, 45},
    ScanField{"yaw_deg", &ScanOptions::yaw_deg, -180, 180},
    ScanField{"find_mounting", &ScanOptions::find_mounting},
    ScanField{"camera_ahead_m", &ScanOptions::camera_ahead_m, -10, 10},
    ScanField{"camera_left_m", &ScanOptions::camera_left_m, -10, 10},
    ScanField{"ground", &ScanOptions::ground},
    ScanField{"imu_axes", &ScanOptions::imu_axes},
    ScanField{"low_m", &ScanOptions::low_m, -30, 30},
    ScanField{"high_m", &ScanOptions::high_m, -30, 30},
    ScanField{"drop_m", &ScanOptions::drop_m, 0, 10},
    ScanField{"min_m", &ScanOptions::min_m, 0.01, 60},
    ScanField{"max_m", &ScanOptions::max_m, 0.02, 65},
    ScanField{"object_m", &ScanOptions::object_m, 0.01, 10},
    ScanField{"max_error_m", &ScanOptions::max_error_m, 0.001, 65},
    ScanField{"min_confidence", &ScanOptions::min_confidence, 1, 255},
    ScanField{"subpixel_error_px", &ScanOptions::subpixel_error_px, 0.01, 4},
};

/// Returns the value of a number; one that is in range for what is no number.
double value_of(const ScanField& field, const ScanOptions& options) {
    if (const auto* const whole = std::get_if<int ScanOptions::*>(&field.field)) {
        return options.*(*whole);
    }
    const auto* const real = std::get_if<double ScanOptions::*>(&field.field);
    return real != nullptr ? options.*(*real) : field.min;
}

std::string number(double value) {
    std::ostringstream text;
    text << value;
    return text.str();
}

}  // namespace

std::string_view to_string(GroundMode mode) {
    switch (mode) {
        case GroundMode::configured: return "configured";
        case GroundMode::fitted: return "fitted";
        case GroundMode::gravity: return "gravity";
        case GroundMode::autopilot: return "autopilot";
    }
    return "";
}

std::optional<GroundMode> parse_ground_mode(std::string_view name) {
    for (const GroundMode mode :
         {GroundMode::fitted, GroundMode::configured, GroundMode::gravity, GroundMode::autopilot}) {
        if (to_string(mode) == name) {
            return mode;
        }
    }
    return std::nullopt;
}

std::span<const ScanField> scan_fields() {
    return fields;
}

std::string validate(const ScanOptions& options) {
    for (const ScanField& field : fields) {
        const double value = value_of(field, options);
        if (!(value >= field.min && value <= field.max)) {  // not a number fails, too
            return std::string(field.name) + " = " + number(value) + ": allowed is " + number(field.min) + " to " +
                   number(field.max);
        }
    }
    const bool field_of_view = options.from_deg == 0 && options.to_deg == 0;
    if (!field_of_view && !(options.to_deg > options.from_deg)) {
        return "to_deg = " + number(options.to_deg) + ": allowed is more than from_deg, " + number(options.from_deg) +
               ", or 0 for both: the field of view";
    }
    if (!(options.high_m > options.low_m)) {
        return "high_m = " + number(options.high_m) + ": allowed is more than low_m, " + number(options.low_m);
    }
    if (!(options.camera_height_m >= options.low_m + 0.02)) {
        return "camera_height_m = " + number(options.camera_height_m) + ": allowed is at least 0.02 more than low_m, " +
               number(options.low_m);
    }
    if (!(options.max_m > options.min_m)) {
        return "max_m = " + number(options.max_m) + ": allowed is more than min_m, " + number(options.min_m);
    }
    if (options.ground == GroundMode::autopilot && options.find_mounting) {
        return "find_mounting = true: allowed is false with ground = \"autopilot\": the floor in view shows how the "
               "camera is turned against it, not how it is mounted on what flies";
    }
    const bool wanted = options.ground == GroundMode::gravity;
    if ((wanted || !options.imu_axes.empty()) && !scan::parse_sensor_axes(options.imu_axes)) {
        return "imu_axes = \"" + options.imu_axes + "\": allowed is " + std::string(scan::sensor_axes_form) +
               (wanted ? "; ground = \"gravity\" needs it" : "");
    }
    return {};
}

}  // namespace disparityd
