// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

#include "capture/frame_source.h"
#include "pipeline/pipeline.h"
#include "pipeline/stage_queue.h"

namespace disparityd::pipeline {

/// The capture stage: takes frames from the source, finds each a slot, applies the policy and counts what is lost.
/// run() is one thread's; the counters may be read by any.
class Intake {
public:
    struct Counters {
        std::atomic<std::uint64_t> captured{0};
        std::atomic<std::uint64_t> dropped{0};
        std::atomic<std::uint64_t> lost_before{0};
        std::atomic<std::uint64_t> corrupt{0};
    };

    Intake(Policy policy, capture::FrameSource& source, FreeSlots& free_slots, StageQueue& first_stage,
           Pipeline::RawTap raw_tap);

    /// Until the source ends or is interrupted, or `stopping` is set. Lets the source's exception through.
    void run(Pulse& pulse, Histogram& time, const std::atomic<bool>& stopping);

    const Counters& counters() const { return counters_; }

private:
    enum class Got { frame, nothing, end };

    Got next_frame(capture::RawFrame& frame, std::chrono::steady_clock::time_point deadline);
    FrameSlot* slot_for_replay(Pulse& pulse, const std::atomic<bool>& stopping);
    FrameSlot* slot_for_newest(capture::RawFrame& frame, Pulse& pulse, const std::atomic<bool>& stopping, bool& ended);
    void drop(const capture::RawFrame& frame);
    void hand_on(FrameSlot* slot, const capture::RawFrame& frame);

    Policy policy_;
    capture::FrameSource& source_;
    FreeSlots& free_slots_;
    StageQueue& first_stage_;
    Pipeline::RawTap raw_tap_;
    Counters counters_;
    std::uint64_t lost_ = 0;  ///< frames lost since the last one that was handed on
};

}  // namespace disparityd::pipeline
