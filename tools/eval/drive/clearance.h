// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/eval/drive/robot.h"
#include "tools/eval/scan/course.h"

namespace disparityd::eval {

/// Returns how far a robot is from the nearest thing of its course that it would hit or fall into, whether its camera
/// sees that or not: m between the robot's side and the thing, below 0 where they meet. Exact for boxes, posts,
/// level wires, holes and the wall, and of a slanted bar for its part between the heights of the robot.
double clearance(const Course& course, const Pose& pose, const Robot& robot);

}  // namespace disparityd::eval
