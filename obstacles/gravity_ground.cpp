// SPDX-License-Identifier: Apache-2.0
#include "obstacles/gravity_ground.h"

#include <algorithm>
#include <cmath>

#include "obstacles/scan_geometry.h"

namespace disparityd::scan {
namespace {

struct NamedDirection {
    std::string_view name;
    CameraDirection direction;
};

constexpr std::array directions{
    NamedDirection{"right", {1, 0, 0}}, NamedDirection{"left", {-1, 0, 0}}, NamedDirection{"down", {0, 1, 0}},
    NamedDirection{"up", {0, -1, 0}},   NamedDirection{"ahead", {0, 0, 1}}, NamedDirection{"back", {0, 0, -1}},
};

double dot(const CameraDirection& a, const CameraDirection& b) {
    return a.right * b.right + a.down * b.down + a.ahead * b.ahead;
}

/// The camera's axes right, down and ahead are right-handed.
CameraDirection cross(const CameraDirection& a, const CameraDirection& b) {
    return {a.down * b.ahead - a.ahead * b.down, a.ahead * b.right - a.right * b.ahead,
            a.right * b.down - a.down * b.right};
}

}  // namespace

CameraDirection SensorAxes::turned(const SensorDirection& direction) const {
    const auto [x, y, z] = direction;
    const double right = x * of[0].right + y * of[1].right + z * of[2].right;
    const double down = x * of[0].down + y * of[1].down + z * of[2].down;
    const double ahead = x * of[0].ahead + y * of[1].ahead + z * of[2].ahead;
    const double length = std::sqrt(right * right + down * down + ahead * ahead);
    return {right / length, down / length, ahead / length};
}

std::optional<SensorAxes> parse_sensor_axes(std::string_view text) {
    SensorAxes axes;
    for (std::size_t i = 0; i < axes.of.size(); ++i) {
        const std::size_t end = i + 1 < axes.of.size() ? text.find(' ') : text.size();
        if (end == std::string_view::npos) {
            return std::nullopt;
        }
        const auto* const found = std::find_if(directions.begin(), directions.end(), [&](const NamedDirection& one) {
            return one.name == text.substr(0, end);
        });
        if (found == directions.end()) {
            return std::nullopt;
        }
        axes.of[i] = found->direction;
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return dot(cross(axes.of[0], axes.of[1]), axes.of[2]) == 1 ? std::optional(axes) : std::nullopt;
}

CameraDirection along_camera(const RobotUp& up, const ScanOptions& options) {
    const auto [ahead, left, above] = turn_of(options);
    return {up.ahead * ahead.right + up.left * left.right + up.up * above.right,
            up.ahead * ahead.down + up.left * left.down + up.up * above.down,
            up.ahead * ahead.ahead + up.left * left.ahead + up.up * above.ahead};
}

std::optional<GroundPlane> level_ground(const CameraDirection& up, const ScanOptions& options) {
    const Turn turn = turn_of(options);
    const double ahead = dot(turn.ahead, up);
    const double left = dot(turn.left, up);
    const double above = dot(turn.up, up);
    if (!(above >= least_upright)) {  // not a number fails, too
        return std::nullopt;
    }
    // The point on the plane below the camera along gravity is the camera's height away. Along the robot's z axis, the
    // plane is farther.
    return GroundPlane{options.camera_height_m * (1 - 1 / above), -ahead / above, -left / above};
}

}  // namespace disparityd::scan
