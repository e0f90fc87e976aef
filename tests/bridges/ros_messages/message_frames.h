// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "clients/cpp/disparity_client.hpp"
#include "proto/disparity.pb.h"

/// Frames whose values decode_foxglove.cjs knows, too: see there before changing one.
namespace disparityd::test {

inline constexpr std::int64_t stamp_ns = 1'700'000'000'123'456'789;
inline constexpr std::uint32_t frame_width = 8;
inline constexpr std::uint32_t frame_height = 4;

/// Returns a plane of frame_width x frame_height pixels.
disparity::PlaneData plane_of_bytes(disparity::Product product, std::uint32_t bytes_per_pixel,
                                    std::vector<std::uint8_t> bytes);

/// Returns a frame without planes: f 100 px, baseline 120 mm, offset 0.25 px, disparities 0 .. 63.
disparity::Frame bare_frame();

/// Returns a frame with a grey image, disparities, depths, depth errors, confidences and a scan. Pixel 0 is rejected,
/// pixel 1 is too far.
disparity::Frame grey_frame();

/// Returns a frame with a coloured image and disparities alone.
disparity::Frame colour_frame();

/// Returns one sample with everything, and one with motion alone, 2.5 ms later.
disparity::SensorBatch sensor_batch();

/// Returns a status with the numbers of the frames.
v1::Status daemon_status();

}  // namespace disparityd::test
