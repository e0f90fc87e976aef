// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <optional>

#include "clients/cpp/disparity_client.hpp"

/// Reads values of a frame's planes. docs/protocol.md defines them.
namespace disparityd::frames {

/// A plane is little endian, as every machine that this is built for.
template <typename T>
T value_at(const disparity::PlaneData& plane, std::uint32_t x, std::uint32_t y) {
    T value;
    const std::size_t pixel = static_cast<std::size_t>(y) * plane.width + x;
    std::memcpy(&value, plane.bytes.data() + pixel * sizeof(T), sizeof(T));
    return value;
}

/// Whether distances have a meaning.
inline bool has_metres(const disparity::FrameInfo& frame) {
    return frame.f > 0 && frame.baseline_mm > 0;
}

/// Returns the distance along the optical axis, Z = f B / (d + offset), in m; nothing where it has no meaning.
std::optional<double> metres(const disparity::FrameInfo& frame, double disparity_px);

/// Returns the disparity (px) of a distance: the reverse.
double disparity_px(const disparity::FrameInfo& frame, double metres);

/// Returns the depth as the product has it, in mm: 0 = unknown, 65535 = beyond 65.534 m.
std::uint16_t depth_mm(const disparity::FrameInfo& frame, std::int16_t disparity16);

/// Whether an image has the bytes for each pixel that its product says, and as many as its size asks for. No daemon of
/// ours sends another one, and what reads planes by their product would read beyond it. False for the scan, which is a
/// record.
bool is_whole_image(const disparity::PlaneData& plane);

/// Returns the image of a product when the frame carries it whole and it is not empty, else nullptr.
const disparity::PlaneData* whole_plane(const disparity::Frame& frame, disparity::Product product);

/// Removes all images that are not whole.
void leave_out_broken_planes(disparity::Frame& frame);

}  // namespace disparityd::frames
