// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/drive/drive.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

#include "clients/examples/obstacle-avoidance/cpp/decision.hpp"
#include "tools/eval/drive/clearance.h"
#include "tools/eval/drive/robot_motion.h"
#include "tools/eval/drive/steering.h"

namespace disparityd::eval {
namespace {

/// Steps of the motion in the time of one frame.
constexpr int steps_per_frame = 4;

avoid::Options options_of(const Robot& robot) {
    avoid::Options options;
    options.width_m = 2 * (robot.radius_m + robot.room_m);
    options.margin_m = robot.margin_m;
    options.speed_mps = robot.speed_mps;
    options.deceleration_mps2 = robot.deceleration_mps2;
    options.reaction_s = robot.reaction_s;
    // A frame is the newest one until the next one is there; a quarter of an interval is for what is late.
    options.max_age_s = robot.latency_s + 1.25 / robot.frames_per_s;
    return options;
}

/// One drive.
class Drive {
public:
    Drive(const Course& course, const Robot& robot, const DriveRules& rules, const Sight& sight)
        : course_(course),
          robot_(robot),
          rules_(rules),
          sight_(sight),
          options_(options_of(robot)),
          decider_(options_),
          steering_(robot, options_),
          motion_(robot) {
        result_.least_clearance_m = clearance(course, motion_.pose(), robot);
    }

    DriveResult run() {
        for (int step = 0; !ended(); ++step) {
            if (step % steps_per_frame == 0) {
                coming_.push_back({motion_.time_s() + robot_.latency_s, sight_(motion_.pose())});
            }
            while (!coming_.empty() && coming_.front().due_s <= motion_.time_s() + 1e-9) {
                decide(coming_.front().seen);
                coming_.pop_front();
            }
            motion_.move(1 / (robot_.frames_per_s * steps_per_frame));
            note();
        }
        result_.seconds = motion_.time_s();
        result_.last_reason = decider_.decision().reason;
        return std::move(result_);
    }

private:
    struct Coming {
        double due_s;
        Seen seen;
    };

    void decide(const Seen& seen) {
        const avoid::Decision decision = decider_.see({robot_.latency_s, seen.flags, &seen.scan}, motion_.time_s());
        const Pose& pose = motion_.pose();
        // Beyond the goal's line, so that the robot comes there straight.
        constexpr double beyond_m = 1;
        const double goal = std::atan2(-pose.y, rules_.goal_m + beyond_m - pose.x) - pose.yaw;
        const double may = std::max(decision.speed_mps, motion_.speed_mps());
        motion_.give({decision.speed_mps, steering_.turn(seen.scan, goal, may, motion_.way_m())});
    }

    void note() {
        const double clear = clearance(course_, motion_.pose(), robot_);
        result_.least_clearance_m = std::min(result_.least_clearance_m, clear);
        result_.collided = clear < 0;
        result_.reached = motion_.pose().x >= rules_.goal_m;
        if (motion_.pose().x > result_.gone_m + 0.05) {
            nearer_s_ = motion_.time_s();
            result_.gone_m = motion_.pose().x;
        }
        const bool moves = motion_.speed_mps() >= avoid::least_speed_mps;
        result_.stops += moved_ && !moves ? 1 : 0;
        moved_ = moves;
        if (rules_.keep_the_track) {
            result_.track.push_back({motion_.pose(), motion_.speed_mps()});
        }
    }

    bool ended() const {
        return result_.collided || result_.reached || motion_.time_s() >= rules_.most_s ||
               motion_.time_s() - nearer_s_ >= rules_.standing_s;
    }

    const Course& course_;
    Robot robot_;
    DriveRules rules_;
    const Sight& sight_;
    avoid::Options options_;
    avoid::Decider decider_;
    Steering steering_;
    RobotMotion motion_;
    std::deque<Coming> coming_;
    double nearer_s_ = 0;  ///< when the robot came nearer to the goal last
    bool moved_ = false;
    DriveResult result_;
};

}  // namespace

DriveResult drive(const Course& course, const Robot& robot, const DriveRules& rules, const Sight& sight) {
    return Drive(course, robot, rules, sight).run();
}

}  // namespace disparityd::eval
