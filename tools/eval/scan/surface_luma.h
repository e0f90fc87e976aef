// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "tools/eval/scan/course.h"

namespace disparityd::eval {

/// The luma of a surface at a point; of a mirror or glass, that of the dirt on it. Structure that is finer than
/// `pixel_m` is left out or fades, as a lens does. `seed` tells one rough surface from another.
double luma(const Surface& surface, Point p, double pixel_m, std::uint32_t seed);

}  // namespace disparityd::eval
