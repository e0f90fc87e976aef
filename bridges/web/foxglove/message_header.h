// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "formats/cdr_writer.h"

/// What many messages begin with or contain.
namespace disparityd::foxglove {

using formats::CdrWriter;

/// The rectified left camera, an optical frame: x right, y down, z ahead. Both cameras' information refers to it.
inline constexpr std::string_view left_frame = "left_camera";
/// The same place with the robot's axes: x ahead, y left, z up. Viewers draw z upwards.
inline constexpr std::string_view camera_frame = "camera";
/// The frame of obstacle scans: on the ground below the camera, x ahead, y left, z up. The daemon does not tell where
/// the camera is in it, so no transform leads there.
inline constexpr std::string_view scan_frame = "camera_footprint";
/// The axes of the inertial sensor. No transform leads from them to the camera's.
inline constexpr std::string_view imu_frame = "camera_imu";

/// Writes a std_msgs/msg/Header. `realtime_ns` is counted from 1970.
void write_header(CdrWriter& cdr, std::int64_t realtime_ns, std::string_view frame);

/// A sensor_msgs/msg/RegionOfInterest. All zero: the whole image.
struct Region {
    std::uint32_t x = 0;       ///< px
    std::uint32_t y = 0;       ///< px
    std::uint32_t width = 0;   ///< px
    std::uint32_t height = 0;  ///< px
};

void write_region(CdrWriter& cdr, const Region& region);

}  // namespace disparityd::foxglove
