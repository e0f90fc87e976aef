// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <csignal>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

namespace disparityd::base {

/// Blocks in the calling thread, as long as it lives, the signals that others send to a process, such as SIGTERM. Those
/// of a fault (SIGSEGV and its like) and of a profiler (SIGPROF) stay as they are. A thread that starts meanwhile
/// inherits this for all its life: so only the thread that waits for signals is ever interrupted by one.
class SignalsBlocked {
public:
    SignalsBlocked();
    ~SignalsBlocked();
    SignalsBlocked(const SignalsBlocked&) = delete;
    SignalsBlocked& operator=(const SignalsBlocked&) = delete;

private:
    sigset_t before_{};
};

/// Throws std::runtime_error with one line for people: the system starts no more threads for this `reason`, or has no
/// memory for the stack of another one, which it reports as the same.
[[noreturn]] void refuse_thread(const std::string& reason);

/// Starts a thread that no signal to the process interrupts (SignalsBlocked). Throws as refuse_thread() when the system
/// starts no more; the caller then ends the threads that it has started before.
template <typename Function>
std::thread start_thread(Function function) {
    const SignalsBlocked inherited;
    try {
        return std::thread(std::move(function));
    } catch (const std::system_error& error) {
        refuse_thread(error.code().message());
    }
}

}  // namespace disparityd::base
