// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "capture/frame_source.h"
#include "capture/rectification.h"
#include "kernels/matcher.h"
#include "pipeline/aligned_buffer.h"

namespace disparityd::pipeline {

/// Everything about one frame on its way. All slots are allocated when the pipeline is configured and are used again
/// and again; a slot is touched by one thread at a time, handed on through the queues.
class FrameSlot {
public:
    /// Which planes there are: what the matcher fills, and these two on demand.
    struct Products {
        bool depth = true;
        bool left_colour = false;
    };

    FrameSlot(const Matcher& matcher, Products products, std::size_t steps);

    capture::RawFrame raw;  ///< its pixels are on loan from the source until rectification has read them
    std::shared_ptr<const capture::Rectification> rectification;  ///< what the frame is rectified with
    Rectifier rectifier;                                          ///< views of it
    FrameView view;                    ///< the planes of this slot, as the matcher and the sinks see them
    std::uint64_t dropped_before = 0;  ///< frames lost by source or pipeline since the one published before

    std::chrono::steady_clock::time_point captured;    ///< when the capture stage got it
    std::vector<std::chrono::nanoseconds> step_times;  ///< one per name of Pipeline::steps()

private:
    AlignedBuffer left_, right_, left_colour_, disparity_, confidence_, depth_, scratch_;
};

}  // namespace disparityd::pipeline
