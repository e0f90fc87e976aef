// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "capture/frame_source.h"
#include "capture/rectification_schedule.h"
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
           capture::RectificationSchedule& rectifications, Pipeline::RawTap raw_tap);

    /// Until the source ends or is interrupted, or `stopping` is set. Lets the source's exception through.
    void run(Pulse& pulse, Histogram& time, const std::atomic<bool>& stopping);

    const Counters& counters() const { return counters_; }

private:
    enum class Got { frame, nothing, end };

    /// A frame and what it will be rectified with.
    struct Taken {
        capture::RawFrame frame;
        std::shared_ptr<const capture::Rectification> rectification;
    };

    Got next_frame(Taken& taken, std::chrono::steady_clock::time_point deadline);
    FrameSlot* slot_for_replay(Pulse& pulse, const std::atomic<bool>& stopping);
    FrameSlot* slot_for_newest(Taken& taken, Pulse& pulse, const std::atomic<bool>& stopping, bool& ended);
    void drop(const capture::RawFrame& frame);
    void hand_on(FrameSlot* slot, Taken&& taken);

    Policy policy_;
    capture::FrameSource& source_;
    FreeSlots& free_slots_;
    StageQueue& first_stage_;
    capture::RectificationSchedule& rectifications_;
    Pipeline::RawTap raw_tap_;
    Counters counters_;
    std::uint64_t lost_ = 0;  ///< frames lost since the last one that was handed on
};

}  // namespace disparityd::pipeline
