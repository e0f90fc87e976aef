// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <deque>
#include <string>

#include "tools/ctl/daemon.h"
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

    /// Throws as connect() does.
    explicit ScanFeed(const DaemonArguments& daemon);

    /// Waits for the next scan. Throws std::runtime_error with one line when the daemon makes no scans. Takes longer
    /// than the timeout where a daemon is being looked for and does not answer: up to 5 s.
    Got next(std::chrono::milliseconds timeout);

    const ScanReading& reading() const { return reading_; }
    const std::string& why() const { return why_; }

private:
    using Clock = std::chrono::steady_clock;

    bool may_make_scans();
    Got lose(const std::string& why);
    Got take();

    disparity::Client client_;
    bool there_ = false;  ///< a frame or silence of the daemon came since it was lost
    disparity::Frame frame_;
    ScanReading reading_;
    std::string why_;
    std::deque<Clock::time_point> arrivals_;  ///< of the last seconds, for the rate
};

}  // namespace disparityd::tools
