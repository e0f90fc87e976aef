// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/eval/conditions/condition.h"

/// Conditions of frames: how eyes stand, when they look, and what happens to images on their way. Each says what its
/// strength is.
namespace disparityd::eval {

EyeError lift_rows(double rows, Draws& draws);         ///< px that the right eye's rows are off, up or down
EyeError change_focal(double per_cent, Draws& draws);  ///< % that the right eye's focal length is off
EyeError look_later(double degrees, Draws& draws);  ///< that the robot turns until the right eye looks; it goes on, too

void compress(EyePair& images, double quality, Draws& draws);  ///< JPEG quality

void tear_one(EyePair& images, const EyePair& before, Draws& draws);     ///< the lower part of one eye is old
void tear_both(EyePair& images, const EyePair& before, Draws& draws);    ///< the same rows of both eyes are old
void lose_blocks(EyePair& images, const EyePair& before, Draws& draws);  ///< runs of blocks are old, and moved

}  // namespace disparityd::eval
