// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/drive/robot_motion.h"

#include <algorithm>
#include <cmath>

namespace disparityd::eval {

void RobotMotion::give(const Command& command) {
    given_.push_back({time_s_ + robot_.reaction_s, command});
}

void RobotMotion::move(double seconds) {
    while (!given_.empty() && given_.front().due_s <= time_s_ + 1e-9) {
        command_ = given_.front().command;
        given_.pop_front();
    }
    const double most = speed_mps_ + robot_.acceleration_mps2 * seconds;
    const double least = speed_mps_ - robot_.deceleration_mps2 * seconds;
    speed_mps_ = std::max(0.0, std::clamp(command_.speed_mps, least, most));
    const double turn = std::clamp(command_.turn_rps, -robot_.turn_rps, robot_.turn_rps);
    pose_.yaw += turn * seconds;
    pose_.x += speed_mps_ * seconds * std::cos(pose_.yaw);
    pose_.y += speed_mps_ * seconds * std::sin(pose_.yaw);
    way_m_ += speed_mps_ * seconds;
    time_s_ += seconds;
}

}  // namespace disparityd::eval
