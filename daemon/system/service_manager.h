// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

namespace disparityd::daemon {

/// Sends the messages of sd_notify() to systemd, or to the program at $NOTIFY_SOCKET; does nothing without one.
class ServiceManager {
public:
    ServiceManager();

    void ready(const std::string& status);
    void reloading();
    void stopping();
    void status(const std::string& line);
    void alive();
    /// Asks for that much time until the next message, while a source prepares itself.
    void needs_time(std::chrono::microseconds time);

    /// Returns how long the daemon may send nothing; zero = no watchdog.
    std::chrono::microseconds watchdog_limit() const { return watchdog_limit_; }

private:
    std::chrono::microseconds watchdog_limit_{0};
};

}  // namespace disparityd::daemon
