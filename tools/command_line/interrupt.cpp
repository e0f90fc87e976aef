// SPDX-License-Identifier: Apache-2.0
#include "tools/command_line/interrupt.h"

#include <atomic>
#include <csignal>

namespace disparityd::tools {
namespace {

std::atomic<bool> flag{false};
static_assert(std::atomic<bool>::is_always_lock_free, "signal handlers need lock-free atomics");

extern "C" void on_signal(int /*number*/) {
    flag.store(true, std::memory_order_relaxed);
}

}  // namespace

void catch_interrupts() {
    struct sigaction action {};
    action.sa_handler = on_signal;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    struct sigaction hang_up {};
    if (sigaction(SIGHUP, nullptr, &hang_up) == 0 && hang_up.sa_handler != SIG_IGN) {  // not below nohup
        sigaction(SIGHUP, &action, nullptr);
    }
}

bool interrupted() {
    return flag.load(std::memory_order_relaxed);
}

}  // namespace disparityd::tools
