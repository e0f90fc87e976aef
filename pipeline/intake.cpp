// SPDX-License-Identifier: Apache-2.0
#include "pipeline/intake.h"

#include <utility>

#include "pipeline/frame_slot.h"

namespace disparityd::pipeline {

using std::chrono::steady_clock;

Intake::Intake(Policy policy, capture::FrameSource& source, FreeSlots& free_slots, StageQueue& first_stage,
               capture::RectificationSchedule& rectifications, Pipeline::RawTap raw_tap)
    : policy_(policy),
      source_(source),
      free_slots_(free_slots),
      first_stage_(first_stage),
      rectifications_(rectifications),
      raw_tap_(std::move(raw_tap)) {}

void Intake::run(Pulse& pulse, Histogram& time, const std::atomic<bool>& stopping) {
    bool ended = false;
    while (!ended && !stopping.load(std::memory_order_relaxed)) {
        Taken taken;
        pulse.beat();
        const Got got = next_frame(taken, steady_clock::now() + pulse_interval);
        if (got == Got::end) {
            return;
        }
        if (got == Got::nothing) {
            continue;
        }
        const auto start = steady_clock::now();
        FrameSlot* slot =
            policy_ == Policy::live ? slot_for_newest(taken, pulse, stopping, ended) : slot_for_replay(pulse, stopping);
        if (slot == nullptr) {
            source_.give_back(taken.frame);
            return;
        }
        const auto waited = policy_ == Policy::live ? steady_clock::duration::zero() : steady_clock::now() - start;
        slot->captured = start;
        slot->step_times[0] = steady_clock::now() - start - waited;
        time.record(slot->step_times[0]);
        hand_on(slot, std::move(taken));
    }
}

Intake::Got Intake::next_frame(Taken& taken, steady_clock::time_point deadline) {
    capture::RawFrame& frame = taken.frame;
    switch (source_.next(frame, deadline)) {
        case capture::FrameSource::Next::timeout: return Got::nothing;
        case capture::FrameSource::Next::end:
        case capture::FrameSource::Next::interrupted: return Got::end;
        case capture::FrameSource::Next::frame: break;
    }
    counters_.captured.fetch_add(1, std::memory_order_relaxed);
    counters_.lost_before.fetch_add(frame.dropped_before, std::memory_order_relaxed);
    lost_ += frame.dropped_before;
    taken.rectification = rectifications_.for_frame(frame);
    if (raw_tap_) {
        raw_tap_(frame);
    }
    frame.sensors = {};  // they do not live as long as the frame
    if ((frame.flags & capture::frame_flag_corrupt) != 0) {
        counters_.corrupt.fetch_add(1, std::memory_order_relaxed);
        ++lost_;
        source_.give_back(frame);
        return Got::nothing;
    }
    return Got::frame;
}

FrameSlot* Intake::slot_for_replay(Pulse& pulse, const std::atomic<bool>& stopping) {
    FrameSlot* slot = nullptr;
    while (!free_slots_.take(slot, pulse_interval)) {
        pulse.beat();
        if (stopping.load(std::memory_order_relaxed)) {
            return nullptr;
        }
    }
    first_stage_.reserve(pulse);
    return slot;
}

// A slot for the frame at hand, or for a newer one that came while every slot was busy.
FrameSlot* Intake::slot_for_newest(Taken& taken, Pulse& pulse, const std::atomic<bool>& stopping, bool& ended) {
    using namespace std::chrono_literals;
    FrameSlot* slot = nullptr;
    for (;;) {
        if (first_stage_.take_back(slot)) {
            // Its losses pass on to the frame that takes its place.
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
        pulse.beat();
        if (stopping.load(std::memory_order_relaxed)) {
            return nullptr;
        }
        if (ended) {
            // The last frame cannot be replaced any more: wait for a slot.
            if (free_slots_.take(slot, 1ms)) {
                first_stage_.reserve(pulse);
                return slot;
            }
            continue;
        }
        Taken newer;
        Got got = Got::nothing;
        try {
            got = next_frame(newer, steady_clock::now() + 1ms);
        } catch (...) {  // a source that has broken: the frame at hand is lost with it, and counted
            drop(taken.frame);
            throw;
        }
        if (got == Got::frame) {
            drop(taken.frame);
            taken = std::move(newer);
        }
        ended = got == Got::end;
    }
}

void Intake::drop(const capture::RawFrame& frame) {
    source_.give_back(frame);
    counters_.dropped.fetch_add(1, std::memory_order_relaxed);
    ++lost_;
}

void Intake::hand_on(FrameSlot* slot, Taken&& taken) {
    slot->raw = taken.frame;
    slot->view.raw = taken.frame.image;
    if (slot->rectification != taken.rectification) {
        slot->rectification = std::move(taken.rectification);
        slot->rectifier = slot->rectification->rectifier();
        slot->view.depth_scale = slot->rectification->depth_scale();
    }
    slot->dropped_before = lost_;
    lost_ = 0;
    first_stage_.put(slot);
}

}  // namespace disparityd::pipeline
