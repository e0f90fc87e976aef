// SPDX-License-Identifier: Apache-2.0
#include "pipeline/trace.h"

#include <algorithm>
#include <stdexcept>
#include <thread>

namespace disparityd::pipeline {

std::uint16_t Tracer::index_of(std::string_view name) {
    const std::lock_guard lock(mutex_);
    const auto known = std::find(names_.begin(), names_.end(), name);
    if (known != names_.end()) {
        return static_cast<std::uint16_t>(known - names_.begin());
    }
    names_.emplace_back(name);
    return static_cast<std::uint16_t>(names_.size() - 1);
}

void Tracer::begin() {
    const std::lock_guard lock(mutex_);
    if (on()) {
        throw std::logic_error("a trace is being recorded already");
    }
    for (TraceTrack* track : tracks_) {
        track->events_.resize(most_events / tracks_.size());
        track->count_ = 0;
        track->dropped_ = 0;
    }
    begin_ns_ = TraceSpan::now_ns();
    on_.store(true, std::memory_order_seq_cst);
}

TraceLog Tracer::end() {
    const std::lock_guard lock(mutex_);
    if (!on()) {
        throw std::logic_error("no trace is being recorded");
    }
    on_.store(false, std::memory_order_seq_cst);
    TraceLog log;
    log.begin_ns = begin_ns_;
    log.end_ns = TraceSpan::now_ns();
    log.names = names_;
    for (TraceTrack* track : tracks_) {
        while (track->writing_.load(std::memory_order_seq_cst)) {
            std::this_thread::yield();
        }
        std::vector<TraceEvent> events = std::exchange(track->events_, {});
        events.resize(std::min(track->count_, events.size()));
        std::erase_if(events, [&](const TraceEvent& event) { return event.begin_ns < begin_ns_; });
        log.tracks.push_back({track->name_, std::move(events), track->dropped_});
    }
    return log;
}

void Tracer::add(TraceTrack& track) {
    const std::lock_guard lock(mutex_);
    tracks_.push_back(&track);
}

void Tracer::remove(TraceTrack& track) {
    const std::lock_guard lock(mutex_);
    std::erase(tracks_, &track);
}

void TraceTrack::add(const TraceEvent& event) noexcept {
    writing_.store(true, std::memory_order_seq_cst);
    if (tracer_.on_.load(std::memory_order_seq_cst)) {
        if (count_ < events_.size()) {
            events_[count_++] = event;
        } else {
            ++dropped_;
        }
    }
    writing_.store(false, std::memory_order_seq_cst);
}

}  // namespace disparityd::pipeline
