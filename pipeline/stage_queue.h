// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>

#include <blockingconcurrentqueue.h>

#include "pipeline/heartbeat.h"

namespace disparityd::pipeline {

class FrameSlot;

/// moodycamel's defaults, but a waiting thread soon stops spinning: cores are for the workers.
struct QueueTraits : moodycamel::ConcurrentQueueDefaultTraits {
    static constexpr int MAX_SEMA_SPINS = 50;
};
using SlotQueue = moodycamel::BlockingConcurrentQueue<FrameSlot*, QueueTraits>;

/// The lock-free queue in front of a stage: frame slots in order, with room for `capacity` of them. The thread of the
/// previous stage puts slots, that of the stage takes them; take_back() lets the former withdraw a waiting slot.
class StageQueue {
public:
    explicit StageQueue(std::size_t capacity)
        : queue_(capacity + 1, 2, 0),
          producer_(queue_),
          room_(static_cast<ssize_t>(capacity), QueueTraits::MAX_SEMA_SPINS) {}

    /// Waits for room; `heartbeat` beats meanwhile.
    void reserve(Heartbeat& heartbeat) {
        while (!room_.wait(std::chrono::microseconds(heartbeat_interval).count())) {
            heartbeat.beat();
        }
        heartbeat.beat();
    }

    bool try_reserve() { return room_.tryWait(); }

    /// Puts a slot into reserved room. nullptr says that no more frames come.
    void put(FrameSlot* slot) { queue_.enqueue(producer_, slot); }

    /// Waits for the next slot; `heartbeat` beats meanwhile.
    FrameSlot* take(Heartbeat& heartbeat) {
        FrameSlot* slot = nullptr;
        while (!queue_.wait_dequeue_timed(slot, heartbeat_interval)) {
            heartbeat.beat();
        }
        heartbeat.beat();
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

/// Slots that are free for the next frame. One thread takes and may put back, another returns finished ones. Each has a
/// producer token of its own, made beforehand: otherwise its first put would allocate.
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
