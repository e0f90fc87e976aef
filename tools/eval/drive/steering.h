// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clients/cpp/disparity_client.hpp"
#include "clients/examples/obstacle-avoidance/cpp/decision.hpp"
#include "tools/eval/drive/robot.h"

namespace disparityd::eval {

/// Chooses where a robot turns on its way to a goal. How fast it may drive is the decision of the example
/// obstacle-avoidance, whose corridor is straight: a robot that drives turns only so fast that it stays in the corridor
/// until it stands. One that stands turns as fast as it can. One thread uses it.
class Steering {
public:
    Steering(const Robot& robot, const avoid::Options& options) : robot_(robot), options_(options) {}

    /// Returns the turn for a scan, radians in a second. `goal` is the goal's bearing, radians; `speed_mps` the speed
    /// that the robot may have; `way_m` how far it has gone since the drive began.
    double turn(const disparity::Scan& scan, double goal, double speed_mps, double way_m);

private:
    enum Side : unsigned char { left, right };

    void watch_sides(const disparity::Scan& scan, double way_m);
    double wanted_turn(const disparity::Scan& scan, double goal);

    Robot robot_;
    avoid::Options options_;
    double beside_[2] = {-1e9, -1e9};  ///< the way at which something was seen last beside the corridor, by Side
    int around_ = 0;                   ///< 1: left, -1: right around what blocks the way; 0: nothing does
};

}  // namespace disparityd::eval
