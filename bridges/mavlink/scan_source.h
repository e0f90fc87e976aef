// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "clients/cpp/disparity_client.hpp"

namespace disparityd::mavlink {

/// A scan and when it was measured.
struct TimedScan {
    disparity::Scan scan;
    /// When its frame was captured; or earlier, of a daemon on another machine (FrameInfo::age_ns).
    std::chrono::steady_clock::time_point captured;
    bool synthetic = false;   ///< the frame was rendered
    std::uint32_t flags = 0;  ///< of the frame, with its doubts (proto/doubt.h)
};

/// Reads scans of a daemon that may be away, come and go. One thread uses it.
class ScanSource {
public:
    /// Reads the daemon `where`, as disparity::connect() takes it, and asks for at most so many frames per second.
    /// Throws std::invalid_argument for a name or an address of another form; a daemon that is away is waited for.
    ScanSource(const std::string& where, disparity::ClientOptions options, double max_rate);
    virtual ~ScanSource() = default;
    ScanSource(const ScanSource&) = delete;
    ScanSource& operator=(const ScanSource&) = delete;

    /// Returns the newest scan that was not returned before; older ones are left out. Waits for one until the timeout,
    /// and longer when a connection is made anew: up to a second. Throws nothing that a daemon does: problem() says it.
    std::optional<TimedScan> next(std::chrono::milliseconds timeout);

    /// Returns one line: why the last next() returned none, and what to do; empty when there was just no new frame.
    const std::string& problem() const { return problem_; }

protected:
    ScanSource() = default;

    /// As Client::read().
    virtual disparity::ReadResult read(disparity::Frame& frame, std::chrono::milliseconds timeout);
    virtual std::string why_gone() const;

private:
    std::optional<TimedScan> scan_of(std::chrono::steady_clock::time_point captured);
    void fail(const std::string& reason);

    std::optional<disparity::Client> client_;
    bool served_ = false;  ///< a frame has come of this daemon
    disparity::Frame frame_;
    std::string problem_;
    std::chrono::steady_clock::time_point next_try_{};
};

}  // namespace disparityd::mavlink
