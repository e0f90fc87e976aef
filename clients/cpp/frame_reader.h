// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <optional>

#include "clients/cpp/connection.h"
#include "clients/cpp/frame_flow.h"
#include "clients/cpp/skipped.h"

namespace disparity {

/// Reads frames from a connection: the newest one, with its age when the program gets it. Gives the daemon credit as
/// the program reads.
class FrameReader {
public:
    /// `connection` outlives this object.
    explicit FrameReader(Connection& connection) : connection_(connection) {}

    /// A subscription begins.
    void start(const Subscription& subscription);
    /// It begins again, over another connection.
    void start_again();

    /// Is called for messages that are no frames.
    using Other = std::function<void()>;

    /// As SocketClient::read(), of a connection that is not lost.
    ReadResult read(Frame& frame, Deadline deadline, const Other& other);

    /// Keeps the frame that the connection has received, in place of the one kept before, for read().
    void keep();

private:
    /// A frame that came, and when.
    struct Known {
        std::int64_t captured_ns = 0;  ///< by the daemon's clock, also of a replay
        std::int64_t sent_ns = 0;      ///< by the daemon's clock; 0 = a daemon that does not say
        std::int64_t age_ns = 0;       ///< when sent
        std::int64_t came_ns = 0;      ///< by this program's clock
        std::int64_t empty_ns = 0;     ///< by this program's clock: the socket was empty then, before it came
    };

    bool drain(Frame& frame, const Other& other);
    void take_message(Frame& frame, const Other& other);
    Known take(Frame& frame);
    bool is_fresh(const Frame& frame);
    FrameFlow::Arrival arrival(const Frame& frame, const Known& known) const;
    ReadResult give(Frame& frame);
    void give_credit(bool waiting);

    Connection& connection_;
    FrameFlow flow_;
    SkippedCounter skipped_;
    double max_rate_ = 0;
    bool wants_frames_ = false;
    std::optional<Frame> kept_;   ///< came during another call
    bool has_frame_ = false;      ///< read() has one, which it may give
    Known known_;                 ///< of that frame
    Frame spare_;                 ///< for the one behind it
    std::exception_ptr problem_;  ///< what came behind a frame that was given, for the next read()
};

}  // namespace disparity
