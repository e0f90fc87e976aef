// SPDX-License-Identifier: Apache-2.0
#include "pipeline/frame_slot.h"

#include "kernels/near_plane.h"
#include "kernels/round_up_to_cache_line.h"

namespace disparityd::pipeline {

namespace {

template <typename T>
Plane<T> allocate(LargeBuffer& buffer, int width, int height) {
    buffer = LargeBuffer(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * sizeof(T));
    return buffer.plane<T>(width, height);
}

}  // namespace

FrameSlot::FrameSlot(const Matcher& matcher, Products products, std::span<AddedStage* const> stages, std::size_t steps)
    : step_times(steps) {
    const int width = matcher.config().width;
    const int height = matcher.config().height;
    view.left = allocate<std::uint8_t>(left_, width, height);
    view.right = allocate<std::uint8_t>(right_, width, height);
    view.disparity = allocate<std::int16_t>(disparity_, width, height);
    view.confidence = allocate<std::uint8_t>(confidence_, width, height);
    if (products.depth) {
        view.depth = allocate<std::uint16_t>(depth_, width, height);
    }
    if (products.depth_error) {
        view.depth_error = allocate<std::uint16_t>(depth_error_, width, height);
        view.subpixel_error = *products.depth_error;
    }
    if (matcher.config().options.post.near_guard) {
        view.near = allocate<std::int16_t>(near_, near_blocks(width), near_blocks(height));
    }
    if (products.left_colour) {
        view.left_colour = allocate<std::uint8_t>(left_colour_, 3 * width, height);
    }
    if (products.right_colour) {
        view.right_colour = allocate<std::uint8_t>(right_colour_, 3 * width, height);
    }
    if (products.raw) {
        raw_eyes = {allocate<std::uint8_t>(raw_left_, width, height),
                    allocate<std::uint8_t>(raw_right_, width, height)};
    }
    scratch_ = LargeBuffer(matcher.scratch_bytes());
    view.scratch = {scratch_.data(), scratch_.size()};
    std::size_t bytes = 0;
    for (const AddedStage* stage : stages) {
        bytes += round_up_to_cache_line(stage->bytes_per_frame());
    }
    stage_memory_ = LargeBuffer(bytes);
    std::byte* next = stage_memory_.data();
    for (const AddedStage* stage : stages) {
        stage_memory.emplace_back(next, stage->bytes_per_frame());
        next += round_up_to_cache_line(stage->bytes_per_frame());
    }
}

}  // namespace disparityd::pipeline
