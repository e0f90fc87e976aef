// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/drive/clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace disparityd::eval {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// From a point to an upright box, seen from above; 0 inside.
double to_box(const Pose& pose, const Obstacle& box) {
    const double x = std::max(std::abs(pose.x - box.centre.x) - box.half.x, 0.0);
    const double y = std::max(std::abs(pose.y - box.centre.y) - box.half.y, 0.0);
    return std::hypot(x, y);
}

/// From a point to a line from (x, from) to (x, to), which lies across the way.
double to_line(const Pose& pose, double x, double from, double to) {
    return std::hypot(pose.x - x, pose.y - std::clamp(pose.y, from, to));
}

/// Which part of a bar, -1 .. 1 from its lower right to its upper left end, is as high as the robot.
double to_bar(const Pose& pose, const Obstacle& bar, double low, double high) {
    double from = -1;
    double to = 1;
    if (bar.half.z != 0) {
        const double a = (low - bar.centre.z) / bar.half.z;
        const double b = (high - bar.centre.z) / bar.half.z;
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
    }
    if (from > to) {
        return never;
    }
    const double one = bar.centre.y + from * bar.half.y;
    const double other = bar.centre.y + to * bar.half.y;
    return to_line(pose, bar.centre.x, std::min(one, other), std::max(one, other)) - bar.half.x;
}

double to_obstacle(const Obstacle& obstacle, const Pose& pose, double low, double high) {
    const Point& centre = obstacle.centre;
    const Point& half = obstacle.half;
    const auto is_between = [&](double half_height) {
        return centre.z + half_height > low && centre.z - half_height < high;
    };
    switch (obstacle.shape) {
        case Obstacle::Shape::box: return is_between(half.z) ? to_box(pose, obstacle) : never;
        case Obstacle::Shape::post:
            return is_between(half.z) ? std::hypot(pose.x - centre.x, pose.y - centre.y) - half.x : never;
        case Obstacle::Shape::wire:
            return is_between(half.x) ? to_line(pose, centre.x, centre.y - half.y, centre.y + half.y) - half.x : never;
        case Obstacle::Shape::bar: return to_bar(pose, obstacle, low, high);
        case Obstacle::Shape::hole: return to_box(pose, obstacle);
    }
    return never;
}

}  // namespace

double clearance(const Course& course, const Pose& pose, const Robot& robot) {
    double nearest = course.wall_m - pose.x;
    for (const Obstacle& obstacle : course.obstacles) {
        nearest = std::min(nearest, to_obstacle(obstacle, pose, robot.low_m, robot.height_m));
    }
    return nearest - robot.radius_m;
}

}  // namespace disparityd::eval
