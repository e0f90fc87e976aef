// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

namespace disparityd::capture {

/// A thread, or std::runtime_error with one line for people where the system starts no more of them. Whoever catches it
/// has to end the threads that were started before.
template <typename Function>
std::thread start_thread(Function function) {
    try {
        return std::thread(std::move(function));
    } catch (const std::system_error& error) {
        throw std::runtime_error("the system starts no more threads: " + error.code().message() +
                                 ": allow more (ulimit -u, TasksMax= of a service, the pids limit of a container) or "
                                 "choose fewer workers");
    }
}

}  // namespace disparityd::capture
