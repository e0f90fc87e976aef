// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>

#include "daemon/socket/frames/frame_ring.h"

namespace disparityd::daemon {

/// Chooses the frames of the ring that one client is sent, in order, and counts the others. A frame is skipped if it
/// lacks a product that the client wants, comes too early for the client's rate, or leaves the ring before the client
/// can take it. A slow client continues with the oldest frame in the ring, or with the newest where it gives credit.
/// One thread (the server's).
class FrameFeed {
public:
    /// What take() returns of several frames.
    enum class Order { oldest_first, newest_only };

    /// Starts with the first frame that `ring` gets after this call. `max_rate`: frames per second, by their times of
    /// publication; 0 = every frame. Frames before the first one that is sent do not count as skipped.
    void start(const FrameRing& ring, double max_rate, Order order = Order::oldest_first);

    /// Returns the next frame that has all of `products` (product_bit()s) and is due, or nullptr. A frame that was
    /// returned or skipped is not returned again.
    FrameHandle take(const FrameRing& ring, std::uint32_t products);

    /// Returns whether the ring has a frame that take() has not looked at.
    bool has_next(const FrameRing& ring) const { return ring.next(next_index_) != nullptr; }

    /// Returns whether take() would return this frame, which has all products that the client wants. Always false with
    /// a rate: the answer would depend on the times.
    bool would_take(const FrameRing& ring, const FrameHandle& frame) const {
        return max_rate_ == 0 && ring.next(next_index_) != nullptr &&
               (order_ == Order::newest_only ? ring.newest() : ring.next(next_index_)) == frame;
    }

    /// Counts a frame as sent. Returns how many frames were published between the previously sent one and this one.
    std::uint64_t count_sent(std::uint64_t publish_index);

    /// Totals since this object was made.
    std::uint64_t frames_sent() const { return frames_sent_; }
    std::uint64_t frames_skipped() const { return frames_skipped_; }

private:
    using Time = std::chrono::steady_clock::time_point;

    Time::duration interval() const;
    bool is_due(Time published) const;
    void count_due(Time published);

    Order order_ = Order::oldest_first;
    double max_rate_ = 0;
    Time next_due_;                 ///< when the next frame is published, at the steady rate
    std::uint64_t next_index_ = 0;  ///< first publish index not yet looked at
    bool has_sent_ = false;         ///< since start()
    std::uint64_t last_sent_ = 0;   ///< publish index
    std::uint64_t frames_sent_ = 0;
    std::uint64_t frames_skipped_ = 0;
};

}  // namespace disparityd::daemon
