// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "daemon/frame_encoder.h"
#include "daemon/frame_pool.h"

namespace disparityd {

/// The newest frames, kept once for all clients: each client remembers only how far it has read, so that its queue is
/// bounded and costs nothing. What one client had encoded is shared with others that want the same while it is on its
/// way to any of them. One thread (the server's).
class FrameRing {
public:
    explicit FrameRing(std::size_t capacity) : capacity_(capacity) {}

    void set_capacity(std::size_t capacity);
    void put(FrameHandle frame);
    void clear() { entries_.clear(); }

    /// The oldest frame with at least this publish index; nullptr when there is none.
    FrameHandle next(std::uint64_t publish_index) const;

    /// One more than the publish index of the newest frame.
    std::uint64_t end() const { return end_; }

    /// The frame must come from next(); may throw as FrameEncoder.
    std::shared_ptr<const EncodedPlanes> encoded(const FrameHandle& frame, const Selection& selection);

private:
    struct Entry {
        FrameHandle frame;
        struct Variant {
            Selection selection;
            std::weak_ptr<const EncodedPlanes> planes;
        };
        std::vector<Variant> variants;
    };
    void trim();

    std::size_t capacity_;
    std::uint64_t end_ = 0;
    std::deque<Entry> entries_;
    FrameEncoder encoder_;
};

}  // namespace disparityd
