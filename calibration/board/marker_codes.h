// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace disparityd::calibration {

/// A family of square black markers with a code of side x side bits within a black rim, as ArUco has them.
struct MarkerFamily {
    std::string_view name;
    int side = 0;
    int tolerated = 0;                     ///< number of wrong bits with which a marker is still recognised
    std::span<const std::uint64_t> codes;  ///< by number; row by row from the upper left, first bit highest, 1 = white
};

/// Returns the family "4x4", "5x5" or "6x6" of 250 markers; nullptr for another name.
const MarkerFamily* marker_family(std::string_view name);

/// A marker's number, and the quarter turns clockwise that turn the bits into its code.
struct MarkerReading {
    int number = 0;
    int turns = 0;
};

/// Looks up a marker by its bits; nothing when they are no marker of the family.
std::optional<MarkerReading> read_code(const MarkerFamily& family, std::uint64_t bits);

}  // namespace disparityd::calibration
