// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>

#include "daemon/log.h"

namespace disparityd::daemon {

/// Watches a name by which clients find the daemon, such as that of its shared memory. Another program may remove or
/// replace it (logind does at logout, RemoveIPC=); new clients would then find nothing.
class PlaceWatch {
public:
    /// Calls `make_anew` when the place is not ours any more; to be called at every tick, by one thread. When
    /// make_anew() throws std::exception with one line, the next attempt comes a second later at the soonest. `place`
    /// is for the log and the notice, and used only when the place is not ours: "shared memory /disparityd.default".
    void check(const std::string& place, bool ours, const std::function<void()>& make_anew);

    /// Removes the notice, because a new configuration has come.
    void forget();

    /// Returns a line for the status; empty when there is nothing to say. Any thread.
    std::string notice() const;

private:
    void say(const std::string& line);

    std::chrono::steady_clock::time_point next_attempt_;
    std::string place_;
    bool lost_ = false;        ///< the place was lost and is not yet made anew
    std::uint64_t times_ = 0;  ///< how often it was made anew
    mutable std::mutex mutex_;
    std::string notice_;
    LogLimiter log_{5, std::chrono::seconds(10)};
};

}  // namespace disparityd::daemon
