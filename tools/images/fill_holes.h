// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/images/disparity_map.h"

namespace disparityd::images {

/// Fills holes as KITTI's development kits do before they count: within a row with the smaller of the two disparities
/// beside the hole, at a row's ends with the one beside it; then the rows at the top that have no disparity at all as
/// the first one that has, those at the bottom as the last. Such rows in between stay, and so does a map without any.
FloatMap fill_from_background(FloatMap map);

/// The same, and each of such rows in between becomes as the row above it: every pixel has a disparity, unless none
/// has.
FloatMap fill_all(FloatMap map);

}  // namespace disparityd::images
