// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/frame_copy.h"

#include <algorithm>
#include <utility>

namespace disparityd::tools {
namespace {

template <typename T>
std::size_t bytes_of(const Plane<T>& plane) {
    return plane ? static_cast<std::size_t>(plane.width) * static_cast<std::size_t>(plane.height) * sizeof(T) : 0;
}

/// Copies a plane to where `memory` points, and moves that behind it.
template <typename T>
Plane<T> copied(const Plane<T>& plane, std::byte*& memory) {
    if (!plane) {
        return {};
    }
    const Plane<T> copy{reinterpret_cast<T*>(memory), plane.width, plane.height, plane.width};
    for (int y = 0; y < plane.height; ++y) {
        std::copy_n(plane.row(y), plane.width, copy.row(y));
    }
    memory += bytes_of(plane);
    return copy;
}

}  // namespace

void FrameCopy::take(const FrameView& frame, std::shared_ptr<const calibration::Rectification> rectification) {
    rectification_ = std::move(rectification);
    memory_.resize(bytes_of(frame.disparity) + bytes_of(frame.depth) + bytes_of(frame.depth_error) +
                   bytes_of(frame.confidence) + bytes_of(frame.left) + bytes_of(frame.right) +
                   bytes_of(frame.left_colour) + bytes_of(frame.right_colour));
    std::byte* to = memory_.data();
    view_ = {};
    // Those of two bytes come first, so that each lies at a place that it may have.
    view_.disparity = copied(frame.disparity, to);
    view_.depth = copied(frame.depth, to);
    view_.depth_error = copied(frame.depth_error, to);
    view_.confidence = copied(frame.confidence, to);
    view_.left = copied(frame.left, to);
    view_.right = copied(frame.right, to);
    view_.left_colour = copied(frame.left_colour, to);
    view_.right_colour = copied(frame.right_colour, to);
}

}  // namespace disparityd::tools
