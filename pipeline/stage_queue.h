// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include <concurrentqueue/blockingconcurrentqueue.h>

namespace disparityd::pipeline {

class FrameSlot;

/// The sign of life of a stage thread: when it last came round its loop.
class Pulse {
public:
    void beat() { last_ns_.store(now_ns(), std::memory_order_relaxed); }
    std::chrono::nanoseconds silence() const {
        return std::chrono::nanoseconds(now_ns() - last_ns_.load(std::memory_order_relaxed));
    }

private:
    static std::int64_t now_ns() { return std::chrono::steady_clock::now().time_since_epoch().count(); }
    std::atomic<std::int64_t> last_ns_{now_ns()};
};

/// How long a stage sleeps at most before it shows that it lives.
inline constexpr std::chrono::milliseconds pulse_interval{100};

/// moodycamel's defaults but for the spinning before sleep: cores are for the workers.
struct QueueTraits : moodycamel::ConcurrentQueueDefaultTraits {
    static constexpr int MAX_SEMA_SPINS = 50;
};
using SlotQueue = moodycamel::BlockingConcurrentQueue<FrameSlot*, QueueTraits>;

/// The lock-free queue in front of a stage: frame slots in order, with room for `capacity` of them. One thread puts
/// (the stage before), one takes; take_back() lets the putting thread withdraw what nobody took yet.
class StageQueue {
public:
    explicit StageQueue(std::size_t capacity)
        : queue_(capacity + 1, 2, 0),
          producer_(queue_),
          room_(static_cast<ssize_t>(capacity), QueueTraits::MAX_SEMA_SPINS) {}

    /// Waits for room, beating `pulse` meanwhile.
    void reserve(Pulse& pulse) {
        while (!room_.wait(std::chrono::microseconds(pulse_interval).count())) {
            pulse.beat();
        }
        pulse.beat();
    }

    bool try_reserve() { return room_.tryWait(); }

    /// Puts a slot into reserved room. nullptr is the mark that no more frames come.
    void put(FrameSlot* slot) { queue_.enqueue(producer_, slot); }

    /// Waits for the next slot, beating `pulse` meanwhile.
    FrameSlot* take(Pulse& pulse) {
        FrameSlot* slot = nullptr;
        while (!queue_.wait_dequeue_timed(slot, pulse_interval)) {
            pulse.beat();
        }
        pulse.beat();
        room_.signal();
        return slot;
    }

    /// The oldest waiting slot, its room still reserved; false when there is none.
    bool take_back(FrameSlot*& slot) { return queue_.try_dequeue(slot); }

private:
    SlotQueue queue_;
    moodycamel::ProducerToken producer_;
    moodycamel::LightweightSemaphore room_;
};

/// Slots that are free for the next frame. One thread takes and may put back, another returns finished ones; each has
/// its own place in the queue, made beforehand, so that nothing is allocated when a thread puts for the first time.
class FreeSlots {
public:
    explicit FreeSlots(std::size_t slots) : queue_(slots + 1, 2, 0), taker_(queue_), finisher_(queue_) {}

    void put_back(FrameSlot* slot) { queue_.enqueue(taker_, slot); }
    void put_finished(FrameSlot* slot) { queue_.enqueue(finisher_, slot); }
    bool try_take(FrameSlot*& slot) { return queue_.try_dequeue(slot); }
    bool take(FrameSlot*& slot, std::chrono::microseconds timeout) { return queue_.wait_dequeue_timed(slot, timeout); }

private:
    SlotQueue queue_;
    moodycamel::ProducerToken taker_;
    moodycamel::ProducerToken finisher_;
};

}  // namespace disparityd::pipeline
