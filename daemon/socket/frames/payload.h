// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "daemon/socket/frames/frame_pool.h"

namespace disparityd::daemon {

/// The bytes behind the Envelope of a frame: those of the frame in place, or bytes of its own. One thread at a time.
class Payload {
public:
    Payload() = default;

    /// Owns `bytes`.
    explicit Payload(std::vector<std::uint8_t> bytes);

    /// `parts` lie in `frame`, which it holds; nothing is copied.
    Payload(std::vector<std::span<const std::uint8_t>> parts, FrameHandle frame);

    Payload(Payload&&) = default;
    Payload& operator=(Payload&&) = default;
    Payload(const Payload&) = delete;
    Payload& operator=(const Payload&) = delete;

    /// Returns the bytes to send, part by part. Valid until keep_copy().
    const std::vector<std::span<const std::uint8_t>>& parts() const { return parts_; }

    /// Returns the bytes of all parts.
    std::size_t size() const { return size_; }

    /// Returns how many bytes are its own: copied or compressed.
    std::size_t own_bytes() const { return bytes_.size(); }

    /// Copies the bytes of the frame and releases it, so that the pool can reuse its memory.
    void keep_copy();

private:
    std::vector<std::span<const std::uint8_t>> parts_;
    std::vector<std::uint8_t> bytes_;
    FrameHandle frame_;  ///< null: the parts lie in bytes_
    std::size_t size_ = 0;
};

}  // namespace disparityd::daemon
