// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/eval/scan/course_maker.h"

/// Conditions of what stands in the course. Each adds to it, and says what its strength is.
namespace disparityd::eval {

void add_fence(CourseMaker& m, double metres);             ///< m that a fence of upright bars is wide
void tile_ground(CourseMaker& m, double share);            ///< % of the ground's look that repeats
void add_level_blinds(CourseMaker& m, double share);       ///< % of the look that repeats
void add_upright_blinds(CourseMaker& m, double share);     ///< the same
void add_chessboard(CourseMaker& m, double share);         ///< the same
void add_plain_wall(CourseMaker& m, double contrast);      ///< grey levels of its structure; far walls are as plain
void add_glass(CourseMaker& m, double share);              ///< % of the pane that is clear; the rest is dirt
void add_mirror(CourseMaker& m, double share);             ///< % of the light that it reflects; the rest is dirt
void add_near_thing(CourseMaker& m, double metres);        ///< m to a box, of any look
void add_level_wires(CourseMaker& m, double thickness);    ///< mm
void add_slanted_wires(CourseMaker& m, double thickness);  ///< mm
void add_pole_pairs(CourseMaker& m, double degrees);       ///< between the two poles of a pair
void add_overhang(CourseMaker& m, double thickness);       ///< m of a plate above free ground
void add_step_down(CourseMaker& m, double depth);          ///< m
void add_hole(CourseMaker& m, double side);                ///< m

}  // namespace disparityd::eval
