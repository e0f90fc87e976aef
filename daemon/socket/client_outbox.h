// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include "daemon/socket/frames/frame_pool.h"
#include "daemon/socket/frames/outgoing_message.h"
#include "proto/disparity.pb.h"

namespace disparityd::daemon {

/// Returns the message that precedes the bytes of a frame's planes. `skipped`: since the frame before.
v1::Envelope frame_head(const FrameCopy& frame, const Selection& selection, const EncodedPlanes& planes,
                        std::uint64_t skipped);

/// What waits to be written to one client: answers, one message on its way, and one compressed frame behind that. It
/// writes nothing itself. Used by the server's thread only.
class ClientOutbox {
public:
    /// Adds an answer behind the others.
    void add(const v1::Envelope& answer);
    std::size_t answers() const { return answers_.size(); }
    /// Returns whether so many answers wait that no more should be asked for.
    bool is_full() const;
    /// Keeps `what` until all answers are sent, or cannot be any more.
    void hold(std::shared_ptr<const void> what) { held_ = std::move(what); }

    /// Returns whether a message has been started and is not sent in full. No other may be started before.
    bool writing() const { return writing_; }

    /// Each starts a message. The first returns false where no answer waits, the last where there is no frame.
    bool start_answer();
    void start(const v1::Envelope& message);
    void start_frame(const v1::Envelope& head, std::shared_ptr<const EncodedPlanes> planes);
    bool start_compressed();

    /// The frame that follows the message on its way; its age is that of the moment at which it is started.
    void keep_compressed(v1::Envelope head, std::chrono::steady_clock::time_point captured,
                         std::shared_ptr<const EncodedPlanes> planes);
    bool has_compressed() const { return compressed_ != nullptr; }
    void drop_compressed() { compressed_.reset(); }

    /// Returns what is not sent yet of the message on its way.
    OutgoingMessage::Buffers rest() const { return message_.rest(); }
    /// Counts bytes. Returns whether the message was sent in full.
    bool sent(std::size_t bytes);
    /// Returns true once for a message that takes longer than the limit.
    bool stalls(std::chrono::steady_clock::duration limit);

    /// Releases the frames: nothing more will be written.
    void release_frames() noexcept;
    /// Forgets all: nothing more can be written.
    void clear() noexcept;

    /// Returns the size of the frame's message that was started last; 0 = none.
    std::size_t frame_bytes() const { return frame_bytes_; }
    /// Returns the bytes of all messages that were sent in full.
    std::uint64_t bytes_sent() const { return bytes_sent_; }

private:
    void begin();

    std::deque<std::vector<std::uint8_t>> answers_;
    std::size_t answer_bytes_ = 0;
    std::shared_ptr<const void> held_;
    OutgoingMessage message_;
    bool writing_ = false;
    bool stall_told_ = false;
    std::chrono::steady_clock::time_point started_;
    v1::Envelope compressed_head_;
    std::chrono::steady_clock::time_point compressed_captured_;
    std::shared_ptr<const EncodedPlanes> compressed_;
    std::size_t frame_bytes_ = 0;
    std::uint64_t bytes_sent_ = 0;
};

}  // namespace disparityd::daemon
