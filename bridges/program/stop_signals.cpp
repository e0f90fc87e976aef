// SPDX-License-Identifier: Apache-2.0
#include "bridges/program/stop_signals.h"

#include <csignal>

namespace disparityd::bridges {
namespace {

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free, "signal handlers need lock-free atomics");

extern "C" void on_signal(int /*number*/) {
    stop.store(true, std::memory_order_relaxed);
}

}  // namespace

const std::atomic<bool>& catch_stop_signals() {
    struct sigaction action {};
    action.sa_handler = on_signal;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(SIGTERM, &action, nullptr);
    sigaction(SIGINT, &action, nullptr);
    return stop;
}

}  // namespace disparityd::bridges
