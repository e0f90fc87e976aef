// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tools/eval/drive/robot.h"
#include "tools/eval/drive/sight.h"
#include "tools/eval/scan/course.h"

namespace disparityd::eval {

/// How a drive is judged.
struct DriveRules {
    double goal_m = 6;            ///< the robot has to come so far ahead
    double most_s = 40;           ///< the drive ends then
    double standing_s = 6;        ///< it ends when the robot has not come nearer for so long
    bool keep_the_track = false;  ///< for a picture
};

/// Where a robot was at a time.
struct Track {
    Pose pose;
    double speed_mps = 0;
};

/// How a robot came through a course.
struct DriveResult {
    bool reached = false;
    bool collided = false;
    double seconds = 0;
    double gone_m = 0;  ///< nearer to the goal than at the start
    int stops = 0;      ///< how often it came to stand before the goal
    double least_clearance_m = 0;
    std::string last_reason;  ///< of the decision with which the drive ended
    std::vector<Track> track;
};

/// Lets a robot drive through a course: each frame is seen at the robot's pose, its scan is there after the robot's
/// latency, the decision of the example obstacle-avoidance gives the speed, and the robot obeys after its reaction
/// time.
DriveResult drive(const Course& course, const Robot& robot, const DriveRules& rules, const Sight& sight);

}  // namespace disparityd::eval
