// SPDX-License-Identifier: Apache-2.0
#include "tools/command_line/interrupt.h"

#include <atomic>
#include <csignal>

namespace disparityd::tools {
namespace {

std::atomic<int> count{0};
std::atomic<int> first{0};
static_assert(std::atomic<int>::is_always_lock_free, "signal handlers need lock-free atomics");

extern "C" void on_signal(int number) {
    int none = 0;
    first.compare_exchange_strong(none, number, std::memory_order_relaxed);
    count.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

void catch_interrupts(SecondSignal second) {
    struct sigaction action {};
    action.sa_handler = on_signal;
    sigaction(SIGTERM, &action, nullptr);
    struct sigaction hang_up {};
    if (sigaction(SIGHUP, nullptr, &hang_up) == 0 && hang_up.sa_handler != SIG_IGN) {  // not below nohup
        sigaction(SIGHUP, &action, nullptr);
    }
    // Only this one: schedulers send the others to a process and to all of its group, and mean one.
    action.sa_flags = second == SecondSignal::is_kept ? 0 : static_cast<int>(SA_RESETHAND);
    sigaction(SIGINT, &action, nullptr);
}

bool interrupted() {
    return interruptions() > 0;
}

int interruptions() {
    return count.load(std::memory_order_relaxed);
}

std::string interrupted_by() {
    switch (first.load(std::memory_order_relaxed)) {
        case SIGTERM: return "SIGTERM";
        case SIGHUP: return "SIGHUP";
        default: return "Ctrl-C";
    }
}

}  // namespace disparityd::tools
