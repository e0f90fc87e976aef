// SPDX-License-Identifier: Apache-2.0
#include "pipeline/capture_stage.h"

#include <algorithm>
#include <thread>
#include <utility>

#include "pipeline/frame_slot.h"

namespace disparityd::pipeline {

using std::chrono::steady_clock;

CaptureStage::CaptureStage(Policy policy, capture::FrameSource& source, FreeSlots& free_slots, StageQueue& first_stage,
                           RectificationSchedule& rectifications, Pipeline::RawTap raw_tap,
                           std::function<bool()> wanted, CoreBudget* budget, TraceTrack& trace,
                           std::uint16_t trace_name)
    : policy_(policy),
      source_(source),
      free_slots_(free_slots),
      first_stage_(first_stage),
      rectifications_(rectifications),
      raw_tap_(std::move(raw_tap)),
      wanted_(std::move(wanted)),
      budget_(budget),
      trace_(trace),
      trace_name_(trace_name) {}

void CaptureStage::run(Heartbeat& heartbeat, Histogram& time, const std::atomic<bool>& stopping) {
    bool ended = false;
    while (!ended && !stopping.load(std::memory_order_relaxed)) {
        PendingFrame pending;
        heartbeat.beat();
        const CaptureResult result = next_frame(pending, steady_clock::now() + heartbeat_interval);
        if (result == CaptureResult::end) {
            return;
        }
        if (result == CaptureResult::nothing) {
            continue;
        }
        if (wanted_ && !wanted_()) {
            give_back(pending.frame, counters_.unwanted);
            continue;
        }
        if (!is_within_budget(heartbeat, stopping)) {
            give_back(pending.frame, counters_.over_budget);
            continue;
        }
        TraceSpan work(trace_, TraceKind::work, trace_name_);
        const auto start = steady_clock::now();
        FrameSlot* slot = policy_ == Policy::live ? slot_for_newest(pending, heartbeat, stopping, ended)
                                                  : slot_for_replay(heartbeat, stopping);
        if (slot == nullptr) {  // the pipeline stops
            drop(pending.frame);
            return;
        }
        const auto waited = policy_ == Policy::live ? steady_clock::duration::zero() : steady_clock::now() - start;
        slot->captured = start;
        slot->step_times[0] = steady_clock::now() - start - waited;
        time.record(slot->step_times[0]);
        work.set_frame(pending.frame.sequence);
        slot->queued_ns = work.on() ? TraceSpan::now_ns() : 0;
        enqueue(slot, std::move(pending));
    }
}

CaptureStage::CaptureResult CaptureStage::next_frame(PendingFrame& pending, steady_clock::time_point deadline) {
    capture::RawFrame& frame = pending.frame;
    switch (next_of_source(frame, deadline)) {
        case capture::FrameSource::Next::timeout: return CaptureResult::nothing;
        case capture::FrameSource::Next::end:
        case capture::FrameSource::Next::interrupted: return CaptureResult::end;
        case capture::FrameSource::Next::frame: break;
    }
    counters_.captured.fetch_add(1, std::memory_order_relaxed);
    counters_.lost.fetch_add(frame.dropped_before, std::memory_order_relaxed);
    lost_ += frame.dropped_before;
    pending.rectification = rectifications_.for_frame(frame);
    if (raw_tap_) {
        raw_tap_(frame);
    }
    gravity_.add(frame.sensors);
    pending.up = gravity_.up_at(frame.monotonic_ns);
    frame.sensors = {};  // their memory ends before the frame does
    if ((frame.flags & capture::frame_flag_corrupt) != 0) {
        give_back(frame, counters_.damaged);
        return CaptureResult::nothing;
    }
    return CaptureResult::frame;
}

capture::FrameSource::Next CaptureStage::next_of_source(capture::RawFrame& frame, steady_clock::time_point deadline) {
    const TraceSpan span(trace_, TraceKind::wait_source, trace_name_);
    return source_.next(frame, deadline);
}

/// Returns whether the frame may begin. Of a replay every frame does, after a while.
bool CaptureStage::is_within_budget(Heartbeat& heartbeat, const std::atomic<bool>& stopping) {
    if (budget_ == nullptr || budget_->admits()) {
        return true;
    }
    if (policy_ == Policy::live) {
        return false;
    }
    const TraceSpan span(trace_, TraceKind::wait_room, trace_name_);
    constexpr std::chrono::milliseconds shortest{1};
    do {
        std::this_thread::sleep_for(std::clamp<CoreBudget::Seconds>(budget_->to_wait(), shortest, heartbeat_interval));
        heartbeat.beat();
    } while (!stopping.load(std::memory_order_relaxed) && !budget_->admits());
    return true;
}

FrameSlot* CaptureStage::slot_for_replay(Heartbeat& heartbeat, const std::atomic<bool>& stopping) {
    const TraceSpan span(trace_, TraceKind::wait_room, trace_name_);
    FrameSlot* slot = nullptr;
    while (!free_slots_.take(slot, heartbeat_interval)) {
        heartbeat.beat();
        if (stopping.load(std::memory_order_relaxed)) {
            return nullptr;
        }
    }
    first_stage_.reserve(heartbeat);
    return slot;
}

// Returns a slot for `pending`, which a newer frame replaces that comes while every slot is busy.
FrameSlot* CaptureStage::slot_for_newest(PendingFrame& pending, Heartbeat& heartbeat, const std::atomic<bool>& stopping,
                                         bool& ended) {
    using namespace std::chrono_literals;
    FrameSlot* slot = nullptr;
    for (;;) {
        if (first_stage_.take_back(slot)) {
            // The frame that replaces it reports its losses too.
            lost_ += slot->dropped_before;
            drop(slot->raw);
            return slot;
        }
        if (free_slots_.try_take(slot)) {
            if (first_stage_.try_reserve()) {
                return slot;
            }
            free_slots_.put_back(slot);
        }
        heartbeat.beat();
        if (stopping.load(std::memory_order_relaxed)) {
            return nullptr;
        }
        if (ended) {
            // No newer frame can come: wait for a slot.
            if (free_slots_.take(slot, 1ms)) {
                first_stage_.reserve(heartbeat);
                return slot;
            }
            continue;
        }
        PendingFrame newer;
        CaptureResult result = CaptureResult::nothing;
        try {
            result = next_frame(newer, steady_clock::now() + 1ms);
        } catch (...) {  // the source failed: the pending frame counts as dropped
            drop(pending.frame);
            throw;
        }
        if (result == CaptureResult::frame) {
            drop(pending.frame);
            pending = std::move(newer);
        }
        ended = result == CaptureResult::end;
    }
}

void CaptureStage::give_back(const capture::RawFrame& frame, std::atomic<std::uint64_t>& counter) {
    source_.give_back(frame);
    counter.fetch_add(1, std::memory_order_release);
    ++lost_;
}

void CaptureStage::enqueue(FrameSlot* slot, PendingFrame&& pending) {
    slot->raw = pending.frame;
    slot->view.raw = pending.frame.image;
    slot->up = pending.up;
    if (slot->rectification != pending.rectification) {
        slot->rectification = std::move(pending.rectification);
        slot->rectifier = slot->rectification->rectifier();
        slot->view.depth_scale = slot->rectification->depth_scale();
    }
    slot->dropped_before = lost_;
    lost_ = 0;
    first_stage_.put(slot);
}

}  // namespace disparityd::pipeline
