// SPDX-License-Identifier: Apache-2.0
#include "daemon/system/service_manager.h"

#include <cstdint>

#include <systemd/sd-daemon.h>

namespace disparityd::daemon {
namespace {

void notify(const std::string& message) {
    sd_notify(0, message.c_str());
}

}  // namespace

ServiceManager::ServiceManager() {
    std::uint64_t limit = 0;
    if (sd_watchdog_enabled(0, &limit) > 0) {
        watchdog_limit_ = std::chrono::microseconds(limit);
    }
}

void ServiceManager::ready(const std::string& status) {
    notify("READY=1\nSTATUS=" + status);
}

void ServiceManager::reloading() {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    notify("RELOADING=1\nMONOTONIC_USEC=" +
           std::to_string(std::chrono::duration_cast<std::chrono::microseconds>(now).count()));
}

void ServiceManager::stopping() {
    notify("STOPPING=1");
}

void ServiceManager::status(const std::string& line) {
    notify("STATUS=" + line);
}

void ServiceManager::alive() {
    notify("WATCHDOG=1");
}

void ServiceManager::needs_time(std::chrono::microseconds time) {
    notify("EXTEND_TIMEOUT_USEC=" + std::to_string(time.count()));
}

}  // namespace disparityd::daemon
