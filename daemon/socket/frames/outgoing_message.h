// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <boost/asio/buffer.hpp>

#include "daemon/socket/frames/frame_encoder.h"

namespace disparityd::daemon {

/// The message that is being written to a client: its head (length and Envelope) and the planes behind it. Keeps the
/// number of bytes sent and no address, because the planes may move between two writes (Payload::keep_copy()). One
/// thread.
class OutgoingMessage {
public:
    using Buffers = std::array<boost::asio::const_buffer, 1 + product_count>;

    /// Starts the next message. Returns the empty buffer of the head; the caller fills it.
    std::vector<std::uint8_t>& start(std::shared_ptr<const EncodedPlanes> planes = nullptr);

    /// Returns the bytes that are not sent yet, in order; buffers may be empty. Valid until keep_copy() of the planes.
    Buffers rest() const;

    void sent(std::size_t bytes) { sent_ += bytes; }

    /// Returns the bytes of the head and all planes.
    std::size_t size() const { return head_.size() + (planes_ ? planes_->bytes.size() : 0); }

    bool is_done() const { return sent_ == size(); }

    /// Releases the planes: all was sent, or nothing more will be.
    void finish() { planes_.reset(); }

private:
    std::vector<std::uint8_t> head_;
    std::shared_ptr<const EncodedPlanes> planes_;  ///< null: the message is the head alone
    std::size_t sent_ = 0;
};

}  // namespace disparityd::daemon
