// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "daemon/socket/frames/frame_encoder.h"
#include "daemon/socket/frames/frame_pool.h"

namespace disparityd::daemon {

/// The newest frames, kept once for all clients. A client keeps only its position, so a client's queue is bounded and
/// takes no memory. Clients with equal selections share the planes of a frame while one of them still needs these. Raw
/// planes lie in the frame while the ring has it. When the ring drops a frame that a slow client still needs, the
/// planes are copied: clients hold no memory of the pool beyond that of the ring. One thread (the server's).
class FrameRing {
public:
    explicit FrameRing(std::size_t capacity) : capacity_(capacity) {}

    void set_capacity(std::size_t capacity);
    void put(FrameHandle frame);
    void clear();

    /// Returns the oldest frame with at least this publish index, or nullptr.
    FrameHandle next(std::uint64_t publish_index) const;

    /// Returns the newest frame, or nullptr.
    FrameHandle newest() const { return entries_.empty() ? nullptr : entries_.back().frame; }

    /// Returns the publish index of the newest frame plus one.
    std::uint64_t end() const { return end_; }

    /// Returns the planes of a frame that the ring has. Throws as FrameEncoder::encode().
    std::shared_ptr<const EncodedPlanes> encoded(const FrameHandle& frame, const Selection& selection);

private:
    struct Entry {
        FrameHandle frame;
        struct Variant {
            Selection selection;
            std::weak_ptr<EncodedPlanes> planes;
        };
        std::vector<Variant> variants;
    };
    void shrink_to(std::size_t frames);

    std::size_t capacity_;
    std::uint64_t end_ = 0;
    std::deque<Entry> entries_;
    FrameEncoder encoder_;
};

}  // namespace disparityd::daemon
