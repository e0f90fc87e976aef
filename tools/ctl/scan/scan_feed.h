// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <deque>
#include <memory>
#include <string>

#include "tools/ctl/daemon_address.h"
#include "tools/ctl/frame_reader.h"
#include "tools/ctl/scan/scan_text.h"

namespace disparityd::tools {

/// Reads the obstacle scans of a running daemon, and finds it again when it was away. One thread uses it.
class ScanFeed {
public:
    enum class Got {
        scan,      ///< reading() has it
        nothing,   ///< nothing new came in time; the daemon lives
        no_daemon  ///< why() says why; later calls look for it again
    };

    /// Throws as open_frames() does.
    explicit ScanFeed(const DaemonAddress& daemon);

    /// Waits for the next scan. Throws std::runtime_error with one line when the daemon makes no scans. Takes longer
    /// than the timeout where a daemon is being looked for and does not answer: up to 5 s.
    Got next(std::chrono::milliseconds timeout);

    const ScanReading& reading() const { return reading_; }
    const std::string& why() const { return why_; }

private:
    using Clock = std::chrono::steady_clock;

    std::unique_ptr<FrameReader> open() const;
    void lose(const std::string& why);
    bool come_back(std::chrono::milliseconds timeout);
    disparity::ReadResult read(std::chrono::milliseconds timeout);
    Got take();

    DaemonAddress daemon_;
    std::unique_ptr<FrameReader> frames_;  ///< null while there is no daemon
    bool old_frame_ = true;                ///< the next one may be old
    Clock::time_point look_again_;
    disparity::Frame frame_;
    ScanReading reading_;
    std::string why_;
    std::deque<Clock::time_point> arrivals_;  ///< of the last seconds, for the rate
};

}  // namespace disparityd::tools
