// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>

#include "tools/eval/drive/robot.h"

namespace disparityd::eval {

/// Moves a robot as its commands say, each after the robot's reaction time. One thread uses it.
class RobotMotion {
public:
    explicit RobotMotion(const Robot& robot) : robot_(robot) {}

    /// Gives a command at the time of the robot's clock.
    void give(const Command& command);

    /// Lets `seconds` pass. The speed comes near that of the command with the robot's acceleration and deceleration.
    void move(double seconds);

    const Pose& pose() const { return pose_; }
    double speed_mps() const { return speed_mps_; }
    double time_s() const { return time_s_; }
    double way_m() const { return way_m_; }  ///< that it has gone

private:
    struct Given {
        double due_s;
        Command command;
    };

    Robot robot_;
    Pose pose_;
    double speed_mps_ = 0;
    double time_s_ = 0;
    double way_m_ = 0;
    Command command_;          ///< that it obeys
    std::deque<Given> given_;  ///< that it will obey
};

}  // namespace disparityd::eval
