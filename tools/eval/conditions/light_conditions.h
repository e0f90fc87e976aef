// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/eval/conditions/condition.h"

/// Conditions of light, lenses and weather: what arrives at the sensors. Each says what its strength is.
namespace disparityd::eval {

void add_noise(Light& light, double sigma, Draws& draws);         ///< grey levels at luma 120
void add_shared_noise(Light& light, double sigma, Draws& draws);  ///< the same, shared by neighbours
void dim(Light& light, double share, Draws& draws);               ///< % of the light that is left
void overexpose(Light& light, double share, Draws& draws);        ///< % of the right exposure
void underexpose(Light& light, double share, Draws& draws);       ///< % of it; the darkest levels are black
void blur_motion(Light& light, double length, Draws& draws);      ///< px, of a robot that turns or goes over a bump
void add_glare(Light& light, double veil, Draws& draws);          ///< grey levels beside a lamp or the sun
void add_flare(Light& light, double level, Draws& draws);         ///< grey levels of images of the sun in the lens
void darken_corners(Light& light, double loss, Draws& draws);     ///< % of the light in the corners
void rain_in_both(Light& light, double drops, Draws& draws);      ///< how many fall in the view
void rain_in_one(Light& light, double drops, Draws& draws);       ///< the same, seen by one eye
void dust_in_both(Light& light, double grains, Draws& draws);     ///< how many are lit near the lenses
void dust_in_one(Light& light, double grains, Draws& draws);      ///< the same, seen by one eye
void drop_on_one(Light& light, double radius, Draws& draws);      ///< px of the drop on one lens
void dirt_on_one(Light& light, double share, Draws& draws);       ///< % of one lens that is dirty
void cover_one(Light& light, double share, Draws& draws);         ///< % of one eye's width
void expose_unequally(Light& light, double share, Draws& draws);  ///< % of the other eye's light

}  // namespace disparityd::eval
