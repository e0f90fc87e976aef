// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tools/ctl/daemon_address.h"

namespace disparityd::tools {

/// Frames of a running daemon, whichever way they come.
class FrameReader {
public:
    virtual ~FrameReader() = default;
    /// As the client library's read(); throws its std::runtime_error.
    virtual disparity::ReadResult read(disparity::Frame& frame, std::chrono::milliseconds timeout) = 0;
    virtual bool local() const = 0;         ///< the daemon's clocks are ours
    virtual std::string where() const = 0;  ///< for people
};

/// Over the socket when the user gave one; else over shared memory, and over the default socket where there is none.
/// Throws std::runtime_error with one line when no daemon is there.
std::unique_ptr<FrameReader> open_frames(const DaemonAddress& daemon, const std::vector<disparity::Product>& products);

/// How old a frame is now, in ns: by our own clock where the daemon's clock is ours and the frame is a live one, else
/// the age that the daemon sent with it.
std::int64_t age_ns(const disparity::Frame& frame, bool local);

}  // namespace disparityd::tools
