// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

namespace disparityd {

/// What the daemon tells systemd (or whoever listens at $NOTIFY_SOCKET); nothing happens when nobody does.
class ServiceManager {
public:
    ServiceManager();

    void ready(const std::string& status);
    void reloading();
    void stopping();
    void status(const std::string& line);
    void alive();
    /// Asks for that much time until the next word, while something slow is being prepared.
    void needs_time(std::chrono::microseconds time);

    /// How long the daemon may be silent; zero = no watchdog.
    std::chrono::microseconds watchdog_limit() const { return watchdog_limit_; }

private:
    std::chrono::microseconds watchdog_limit_{0};
};

}  // namespace disparityd
