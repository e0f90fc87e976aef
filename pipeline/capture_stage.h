// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "capture/frame_source.h"
#include "pipeline/core_budget.h"
#include "pipeline/gravity_filter.h"
#include "pipeline/pipeline.h"
#include "pipeline/rectification_schedule.h"
#include "pipeline/stage_queue.h"
#include "pipeline/trace.h"

namespace disparityd::pipeline {

/// The first stage of the pipeline: takes frames from the source, finds a slot for each, applies the policy and counts
/// lost frames. run() is for one thread; any thread may read the counters.
class CaptureStage {
public:
    struct Counters {
        std::atomic<std::uint64_t> captured{0};
        std::atomic<std::uint64_t> dropped{0};
        std::atomic<std::uint64_t> lost{0};
        std::atomic<std::uint64_t> damaged{0};
        std::atomic<std::uint64_t> unwanted{0};
        std::atomic<std::uint64_t> over_budget{0};
    };

    CaptureStage(Policy policy, capture::FrameSource& source, FreeSlots& free_slots, StageQueue& first_stage,
                 RectificationSchedule& rectifications, Pipeline::RawTap raw_tap, std::function<bool()> wanted,
                 CoreBudget* budget, TraceTrack& trace, std::uint16_t trace_name);

    /// Runs until the source ends or is interrupted, or `stopping` is set. Lets the source's exception through.
    void run(Heartbeat& heartbeat, Histogram& time, const std::atomic<bool>& stopping);

    const Counters& counters() const { return counters_; }

private:
    enum class CaptureResult { frame, nothing, end };

    /// A captured frame, the maps that it will be rectified with, and where up is.
    struct PendingFrame {
        capture::RawFrame frame;
        std::shared_ptr<const calibration::Rectification> rectification;
        std::optional<SensorDirection> up;
    };

    CaptureResult next_frame(PendingFrame& pending, std::chrono::steady_clock::time_point deadline);
    capture::FrameSource::Next next_of_source(capture::RawFrame& frame, std::chrono::steady_clock::time_point deadline);
    bool is_within_budget(Heartbeat& heartbeat, const std::atomic<bool>& stopping);
    FrameSlot* slot_for_replay(Heartbeat& heartbeat, const std::atomic<bool>& stopping);
    FrameSlot* slot_for_newest(PendingFrame& pending, Heartbeat& heartbeat, const std::atomic<bool>& stopping,
                               bool& ended);
    void drop(const capture::RawFrame& frame) { give_back(frame, counters_.dropped); }
    void give_back(const capture::RawFrame& frame, std::atomic<std::uint64_t>& counter);
    void enqueue(FrameSlot* slot, PendingFrame&& pending);

    Policy policy_;
    capture::FrameSource& source_;
    FreeSlots& free_slots_;
    StageQueue& first_stage_;
    RectificationSchedule& rectifications_;
    Pipeline::RawTap raw_tap_;
    const std::function<bool()> wanted_;
    CoreBudget* const budget_;
    GravityFilter gravity_;  ///< gets the samples of all captured frames
    TraceTrack& trace_;
    const std::uint16_t trace_name_;
    Counters counters_;
    std::uint64_t lost_ = 0;  ///< frames that no longer come, since the last one that was enqueued
};

}  // namespace disparityd::pipeline
