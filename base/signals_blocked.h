// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <csignal>

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

}  // namespace disparityd::base
