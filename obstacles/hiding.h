// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "obstacles/right_view.h"

namespace disparityd::scan {

/// The heights of the band from the camera on, and the side of the smallest obstacle in it, in mm.
struct HidingRoom {
    double above;
    double below;
    double side;
};

/// No obstacle hides at any distance.
inline constexpr double nowhere = 1e9;

/// Returns the least distance in mm, at least `least`, at which an obstacle can hide in rows that fall from `top` to
/// `bottom` per horizontal mm. They show, at distance r, the heights r top to r bottom below the camera; an obstacle
/// hides when as much of that is in the band as its side.
double hiding_distance(double top, double bottom, const HidingRoom& room, double least);

/// The same for groups of rows that follow each other, each with what is clear there. `falls` are those of the edges of
/// the groups, one more than there are groups.
double hiding_distance(std::span<const double> falls, std::span<const Clear> clear, const HidingRoom& room,
                       double least);

}  // namespace disparityd::scan
