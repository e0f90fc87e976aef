// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/drive/steering.h"

#include <algorithm>
#include <cmath>

namespace disparityd::eval {
namespace {

/// The way ahead counts up to here.
constexpr double horizon_m = 3;
/// A way that is shorter is blocked.
constexpr double blocked_m = 1.8;
/// The example needs the whole corridor in view; more than so far aside it is not.
constexpr double most_aside_deg = 10;
constexpr double step_deg = 2.5;
/// A degree away from the goal is worth so much less way.
constexpr double metres_per_degree = 0.03;

/// The scan as a robot that has turned left by so much would have it.
disparity::Scan turned(disparity::Scan scan, double left_deg) {
    for (disparity::ScanSector& sector : scan.sectors) {
        sector.from_deg -= left_deg;
        sector.to_deg -= left_deg;
    }
    return scan;
}

double way_in(const disparity::Scan& scan, double left_deg, const avoid::Options& options) {
    return std::min(avoid::way_ahead(turned(scan, left_deg), options).ahead_m, horizon_m);
}

/// The side on which more is free.
int freer_side(const disparity::Scan& scan, double goal) {
    double more_left = goal > 0 ? 1e-6 : -1e-6;
    for (const disparity::ScanSector& sector : scan.sectors) {
        const double free = std::min(sector.free_m, horizon_m);
        more_left += sector.from_deg + sector.to_deg > 0 ? free : -free;
    }
    return more_left > 0 ? 1 : -1;
}

}  // namespace

/// Notes what is so near beside the corridor that a turn towards it would meet it when it is out of view.
void Steering::watch_sides(const disparity::Scan& scan, double way_m) {
    constexpr double from_deg = 25;
    const double near_m = options_.width_m / 2 + robot_.radius_m;
    for (const disparity::ScanSector& sector : scan.sectors) {
        const double bearing = (sector.from_deg + sector.to_deg) / 2;
        if (sector.state == disparity::SectorState::occupied && std::abs(bearing) > from_deg &&
            sector.distance_m * std::sin(radians(std::abs(bearing))) < near_m) {
            beside_[bearing > 0 ? left : right] = way_m;
        }
    }
}

double Steering::wanted_turn(const disparity::Scan& scan, double goal) {
    const double goal_deg = std::clamp(degrees(goal), -90.0, 90.0);
    double best = 0;
    double best_score = -1e9;
    double best_way = 0;
    for (double aside = -most_aside_deg; aside <= most_aside_deg; aside += step_deg) {
        const double way = way_in(scan, aside, options_);
        const double score = way - metres_per_degree * std::abs(aside - goal_deg);
        if (score > best_score) {
            best = aside;
            best_score = score;
            best_way = way;
        }
    }
    if (best_way >= blocked_m) {
        around_ = 0;
        return best;
    }
    around_ = around_ != 0 ? around_ : freer_side(scan, goal);
    // Nothing is found by turning further away from the goal.
    constexpr double farthest_deg = 60;
    if (-around_ * goal_deg > farthest_deg) {
        around_ = -around_;
    }
    return around_ * most_aside_deg;
}

double Steering::turn(const disparity::Scan& scan, double goal, double speed_mps, double way_m) {
    watch_sides(scan, way_m);
    constexpr double within_s = 0.4;
    const double wanted = radians(wanted_turn(scan, goal)) / within_s;
    if (speed_mps < avoid::least_speed_mps) {
        return std::clamp(wanted, -robot_.turn_rps, robot_.turn_rps);
    }
    // On an arc of this turn the robot is so far aside of the straight way when it stands: way^2 turn / (2 speed).
    const double way = avoid::stopping_distance(speed_mps, options_);
    const double most = std::min(robot_.turn_rps, 2 * robot_.room_m * speed_mps / (way * way));
    // What was beside the robot is passed when the robot has gone so far.
    constexpr double passed_m = 0.75;
    const bool beside = way_m - beside_[wanted > 0 ? left : right] < passed_m;
    return beside ? 0 : std::clamp(wanted, -most, most);
}

}  // namespace disparityd::eval
