// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "calibration/rectification.h"
#include "capture/frame_source.h"
#include "kernels/added_stage.h"
#include "kernels/large_buffer.h"
#include "kernels/matcher.h"
#include "pipeline/raw_eyes.h"

namespace disparityd::pipeline {

/// The data of one frame in the pipeline. All slots are allocated when the pipeline is configured, and reused. One
/// thread at a time owns a slot; it passes from thread to thread through the queues.
class FrameSlot {
public:
    /// Says which of the optional planes a slot has.
    struct Products {
        bool depth = true;
        bool left_colour = false;
        bool right_colour = false;
        bool raw = false;  ///< both eyes as captured, in the size of what is matched
        /// The depth error, and for it one sigma of a disparity in 1/256 px.
        std::optional<int> depth_error = std::nullopt;
    };

    FrameSlot(const Matcher& matcher, Products products, std::span<AddedStage* const> stages, std::size_t steps);

    capture::RawFrame raw;  ///< its pixels are lent by the source until rectification has read them
    std::shared_ptr<const calibration::Rectification> rectification;  ///< the maps of this frame
    Rectifier rectifier;                                              ///< views of `rectification`
    FrameView view;                                  ///< the planes of this slot, for the matcher and the sink
    RawEyes raw_eyes;                                ///< likewise, as captured
    std::optional<SensorDirection> up;               ///< as the camera's inertial sensor tells it
    std::vector<std::span<std::byte>> stage_memory;  ///< one per stage of PipelineConfig::stages, in its order
    std::uint64_t dropped_before = 0;  ///< frames that source or pipeline lost since the previous published frame

    std::int64_t queued_ns = 0;  ///< when it was put into a queue, of the steady clock; 0 where nobody traces
    std::chrono::steady_clock::time_point captured;    ///< when the capture stage got it
    std::vector<std::chrono::nanoseconds> step_times;  ///< one per name of Pipeline::steps()

private:
    LargeBuffer left_, right_, left_colour_, right_colour_, raw_left_, raw_right_, disparity_, confidence_, depth_,
        depth_error_, near_, scratch_, stage_memory_;
};

}  // namespace disparityd::pipeline
