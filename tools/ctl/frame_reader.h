// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tools/ctl/daemon_address.h"

namespace disparityd::tools {

/// Reads frames of a running daemon, over shared memory or a socket.
class FrameReader {
public:
    virtual ~FrameReader() = default;
    /// Behaves as the client library's read(), and throws its std::runtime_error.
    virtual disparity::ReadResult read(disparity::Frame& frame, std::chrono::milliseconds timeout) = 0;
    virtual std::string where() const = 0;  ///< for people
    /// Whether the last read() was `gone` because the daemon did not answer: the next one connects anew.
    virtual bool unanswered() const = 0;
};

/// Opens the socket when the user gave one; else shared memory, and the default socket where there is none. `timeout`:
/// to connect. Throws std::runtime_error with one line when there is no daemon.
std::unique_ptr<FrameReader> open_frames(const DaemonAddress& daemon, const std::vector<disparity::Product>& products,
                                         std::chrono::milliseconds timeout = patience_to_connect);

}  // namespace disparityd::tools
