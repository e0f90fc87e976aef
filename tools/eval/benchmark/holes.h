// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace disparityd::eval {

/// How pixels of a result that have no disparity are judged. Errors in px are always of those that have one.
enum class Holes : std::uint8_t {
    /// They are bad in bad-x and D1, as in Middlebury's total of bad and invalid pixels.
    bad,
    /// They do not count: bad-x and D1 are shares of the pixels that have a disparity, whose share is the density.
    left_out,
    /// They are filled before, as KITTI fills them: images::fill_from_background(). What stays is bad.
    filled,
};

/// Its word on the command line: bad, left-out, filled.
std::string_view name(Holes holes);

}  // namespace disparityd::eval
