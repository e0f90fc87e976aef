// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <vector>

#include "tests/vm/camera/camera_model.h"
#include "tests/vm/camera/usbip.h"

namespace simulated_camera {

/// What the camera sees: raw frames of a file, over and over, or the numbered pattern.
class FrameFeed {
public:
    /// An empty name stands for the pattern; `whole`: each frame is all of the file, whatever its size. Throws
    /// std::runtime_error when the file cannot be read.
    FrameFeed(const std::string& file, bool whole);

    /// The frame with this number, valid until the next call. A file that holds less than one frame gives zeros.
    std::span<const std::uint8_t> frame(std::uint32_t number, std::size_t frame_bytes);

private:
    bool from_file_;
    bool whole_;
    std::vector<std::uint8_t> file_;
    std::vector<std::uint8_t> made_;
};

/// What ends a freeze: a command, or also the host, by this or by something that does more.
enum class FrozenUntil { not_frozen, thaw, stream_restart, usb_reset };

/// Faults on command; the counts go down as they happen.
struct Faults {
    FrozenUntil frozen = FrozenUntil::not_frozen;
    int frames_with_error = 0;  ///< sent with the error bit
    int frames_short = 0;       ///< only their first half is sent
    int frames_dropped = 0;     ///< not sent at all
    int transfers_stalled = 0;  ///< answered with a stall
};

struct StreamCounters {
    std::uint32_t number = 0;  ///< of the frame that was due last; goes on when the camera is plugged in again
    std::uint64_t sent = 0;    ///< whole frames
    std::uint64_t late = 0;    ///< not sent because the one before was still under way
};

/// The video endpoint: fills the transfers that the host submits with the payloads of frames, one frame per tick.
class VideoStream {
public:
    VideoStream(FrameFeed& feed, Faults& faults, StreamCounters& counters, UsbIpConnection& host);

    void start(const Mode& mode, std::uint32_t most_payload_bytes);
    void stop();
    bool running() const { return running_; }

    /// Frame intervals have passed.
    void tick(std::uint64_t intervals);

    void submit(Submission submission);
    /// Whether the submission was still there to be taken back.
    bool withdraw(std::uint32_t sequence);

    /// Fills as many transfers as it has data for.
    void pump();

private:
    std::size_t write_payload(std::span<std::uint8_t> room);
    void fill_bulk(const Submission& submission);
    void fill_packets(const Submission& submission);
    bool sending() const { return sent_bytes_ < frame_.size(); }
    void begin_frame();

    FrameFeed& feed_;
    Faults& faults_;
    StreamCounters& counters_;
    UsbIpConnection& host_;
    std::deque<Submission> submissions_;
    Bytes payload_;  // scratch
    bool running_ = false;
    std::size_t frame_bytes_ = 0;
    std::size_t most_payload_bytes_ = 0;
    std::span<const std::uint8_t> frame_;  // the one under way
    std::size_t sent_bytes_ = 0;
    bool with_error_ = false;
    bool odd_frame_ = false;
};

}  // namespace simulated_camera
