// SPDX-License-Identifier: Apache-2.0
#include "bridges/frames/planes.h"

#include <algorithm>
#include <cmath>

#include "proto/products.h"

namespace disparityd::frames {

std::optional<double> metres(const disparity::FrameInfo& frame, double disparity_px) {
    const double shift = disparity_px + frame.disparity_offset;
    if (!has_metres(frame) || shift <= 0) {
        return std::nullopt;
    }
    return frame.f * frame.baseline_mm / shift / 1000;
}

double disparity_px(const disparity::FrameInfo& frame, double metres) {
    return frame.f * frame.baseline_mm / (1000 * metres) - frame.disparity_offset;
}

// docs/algorithm.md, step 13, in the same whole numbers: the daemon's plane has the same bytes.
std::uint16_t depth_mm(const disparity::FrameInfo& frame, std::int16_t disparity16) {
    if (disparity16 == frame.invalid || !has_metres(frame)) {
        return 0;
    }
    const std::int64_t k = std::llround(16 * frame.f * frame.baseline_mm);
    const std::int64_t n = disparity16 + std::llround(16 * frame.disparity_offset);
    const std::int64_t mm = n <= 0 ? 65535 : (k + n / 2) / n;
    return k == 0 ? 0 : static_cast<std::uint16_t>(std::clamp<std::int64_t>(mm, 1, 65535));
}

bool is_whole_image(const disparity::PlaneData& plane) {
    const auto number = static_cast<std::uint32_t>(plane.product);
    return plane.product != disparity::Product::scan && number >= 1 && number <= proto::products.size() &&
           plane.bytes_per_pixel == proto::products[number - 1].bytes_per_pixel &&
           plane.bytes.size() == std::uint64_t{plane.width} * plane.height * plane.bytes_per_pixel;
}

const disparity::PlaneData* whole_plane(const disparity::Frame& frame, disparity::Product product) {
    const disparity::PlaneData* const plane = frame.plane(product);
    return plane != nullptr && !plane->bytes.empty() && is_whole_image(*plane) ? plane : nullptr;
}

void leave_out_broken_planes(disparity::Frame& frame) {
    std::erase_if(frame.planes, [](const disparity::PlaneData& plane) {
        return plane.product != disparity::Product::scan && !is_whole_image(plane);
    });
}

}  // namespace disparityd::frames
