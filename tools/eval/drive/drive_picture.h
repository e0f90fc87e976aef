// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "tools/eval/drive/drive.h"

namespace disparityd::eval {

/// Draws a course from above and the way that a robot took through it: above with matched depth, below with perfect
/// depth. Ahead is to the right; the way's colour says how fast the robot was. Writes a PNG; errors as
/// images::write_file.
void write_drive_picture(const std::string& path, const Course& course, const Robot& robot, const DriveRules& rules,
                         const std::array<DriveResult, 2>& drives);

}  // namespace disparityd::eval
