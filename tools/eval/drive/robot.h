// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

/// A robot that drives through a course: an upright cylinder around the left camera.
namespace disparityd::eval {

struct Robot {
    double radius_m = 0.25;
    double height_m = 0.9;
    double low_m = 0.08;  ///< it drives over what is lower
    double speed_mps = 1.5;
    double acceleration_mps2 = 1;
    double deceleration_mps2 = 2;  ///< of a full brake
    double turn_rps = 1;           ///< radians in a second
    double frames_per_s = 10;
    double latency_s = 0.2;   ///< from the exposure of a frame until its scan is there: two frames
    double reaction_s = 0.1;  ///< from a command until the robot obeys
    double room_m = 0.08;     ///< that the corridor has on each side of the robot
    double margin_m = 0.55;   ///< from the camera to an obstacle before which the robot stands
};

/// Where a robot is in its course, and where it looks.
struct Pose {
    double x = 0;
    double y = 0;
    double yaw = 0;  ///< radians, left is positive
};

inline double degrees(double radians) {
    return radians * 180 / std::numbers::pi;
}

inline double radians(double degrees) {
    return degrees * std::numbers::pi / 180;
}

/// What a robot is told to do.
struct Command {
    double speed_mps = 0;
    double turn_rps = 0;  ///< left is positive
};

}  // namespace disparityd::eval
