// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace disparityd::pipeline {

class TraceTrack;

/// What a thread does, or a frame, for some time.
enum class TraceKind : std::uint8_t {
    work,         ///< a stage works on a frame, with a compute slot where it matches
    step,         ///< a part of `work`; steps follow each other
    help,         ///< a worker does tasks of a stage
    awake,        ///< a worker has no task and waits awake for the next one
    wait_source,  ///< for the source's next frame
    wait_frame,   ///< for a frame in the queue
    wait_room,    ///< for room in the next queue, for a slot, or until the cores are free for a new frame
    wait_slot,    ///< for the right to compute
    queued,       ///< a frame lies in the queue in front of a stage
};

struct TraceEvent {
    std::int64_t begin_ns = 0;  ///< of the steady clock, as the next
    std::int64_t end_ns = 0;
    std::uint64_t frame = 0;  ///< sequence of the source; 0 where none is known
    std::uint16_t name = 0;   ///< index in TraceLog::names: of a stage or a step; 0 where none is known
    TraceKind kind = TraceKind::work;
};

/// What was recorded between Tracer::begin() and Tracer::end().
struct TraceLog {
    struct Track {
        std::string name;                ///< of the thread
        std::vector<TraceEvent> events;  ///< in no order
        std::uint64_t dropped = 0;       ///< for which there was no room, at the end of the time
    };
    std::int64_t begin_ns = 0;
    std::int64_t end_ns = 0;
    std::vector<std::string> names;  ///< the first one is empty
    std::vector<Track> tracks;
};

/// Records what threads do while somebody asks for it. Each thread has a track of its own to write to. While nobody
/// asks, a thread reads one flag and goes on; while somebody does, it writes into memory that begin() has allocated.
class Tracer {
public:
    /// All tracks share this room: 8 MiB.
    static constexpr std::size_t most_events = std::size_t{1} << 18;

    Tracer() = default;
    Tracer(const Tracer&) = delete;
    Tracer& operator=(const Tracer&) = delete;

    /// Whether events are recorded now. Any thread.
    bool on() const { return on_.load(std::memory_order_relaxed); }

    /// Returns the index of a name, the same for the same name. Any thread.
    std::uint16_t index_of(std::string_view name);

    /// Starts to record. Any thread. Throws std::logic_error when it records already, std::bad_alloc.
    void begin();

    /// Stops and returns what was recorded; frees the memory. What had begun before begin(), or has not ended, is not
    /// in it. Any thread. Waits for threads that are just writing an event. Throws std::logic_error when it does not
    /// record.
    TraceLog end();

private:
    friend class TraceTrack;

    void add(TraceTrack& track);
    void remove(TraceTrack& track);

    std::atomic<bool> on_{false};
    std::mutex mutex_;  ///< the rest
    std::int64_t begin_ns_ = 0;
    std::vector<std::string> names_{""};
    std::vector<TraceTrack*> tracks_;
};

/// The events of one thread. That thread writes; the tracer, which must outlive the track, reads.
class TraceTrack {
public:
    TraceTrack(Tracer& tracer, std::string name) : tracer_(tracer), name_(std::move(name)) { tracer_.add(*this); }
    ~TraceTrack() { tracer_.remove(*this); }
    TraceTrack(const TraceTrack&) = delete;
    TraceTrack& operator=(const TraceTrack&) = delete;

    bool on() const { return tracer_.on(); }

    /// Records an event if the tracer is on. Only the track's thread. Allocates nothing.
    void add(const TraceEvent& event) noexcept;

private:
    friend class Tracer;

    Tracer& tracer_;
    const std::string name_;
    /// The thread sets it before it looks at the tracer's flag, and the tracer clears its flag before it looks at this:
    /// one of them sees the other. So what stands below belongs to the thread while both are set, else to the tracer.
    std::atomic<bool> writing_{false};
    std::vector<TraceEvent> events_;
    std::size_t count_ = 0;
    std::uint64_t dropped_ = 0;
};

/// What the calling thread works on, for the workers that help it.
struct TraceWork {
    std::uint64_t frame = 0;
    std::uint16_t name = 0;
};
inline thread_local TraceWork trace_work;

/// Records what a thread does from the constructor on to the destructor.
class TraceSpan {
public:
    TraceSpan(TraceTrack& track, TraceKind kind, std::uint16_t name, std::uint64_t frame = 0)
        : track_(track.on() ? &track : nullptr), event_{track_ != nullptr ? now_ns() : 0, 0, frame, name, kind} {}
    ~TraceSpan() {
        if (track_ != nullptr) {
            event_.end_ns = now_ns();
            track_->add(event_);
        }
    }
    TraceSpan(const TraceSpan&) = delete;
    TraceSpan& operator=(const TraceSpan&) = delete;

    bool on() const { return track_ != nullptr; }
    std::int64_t begin_ns() const { return event_.begin_ns; }  ///< where it is on
    void set_frame(std::uint64_t frame) { event_.frame = frame; }

    static std::int64_t now_ns() {
        return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
    }

private:
    TraceTrack* const track_;
    TraceEvent event_;
};

}  // namespace disparityd::pipeline
