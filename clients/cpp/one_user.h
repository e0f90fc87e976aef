// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <stdexcept>
#include <string>

#include <unistd.h>

namespace disparity {

/// Notices when an object is used by two threads at once, or by a process that is not the one which made it: the bytes
/// of one connection would go to both. Cheap enough for every call.
class OneUser {
public:
    /// Whether both processes may use the object after a fork.
    enum class After { fork_fails, fork_goes };

    /// `what`: the class, for the message.
    explicit OneUser(const char* what, After after = After::fork_fails)
        : what_(what), process_(after == After::fork_fails ? ::getpid() : 0) {}

    /// Holds the object during one call.
    class Call {
    public:
        /// Throws std::invalid_argument with one line: what is wrong, what to do.
        explicit Call(OneUser& user) : user_(user) {
            if (user.process_ != 0 && ::getpid() != user.process_) {
                throw std::invalid_argument(std::string(user.what_) +
                                            ": it was made before fork(), and two processes would read the same "
                                            "connection: make one after fork(), in the process that uses it");
            }
            if (user.busy_.exchange(true, std::memory_order_acquire)) {
                throw std::invalid_argument(std::string(user.what_) +
                                            ": two threads use it at once: give each thread one of its own, or hold a "
                                            "mutex during each call");
            }
        }
        ~Call() { user_.busy_.store(false, std::memory_order_release); }
        Call(const Call&) = delete;
        Call& operator=(const Call&) = delete;

    private:
        OneUser& user_;
    };

private:
    const char* what_;
    pid_t process_;  ///< that made it; 0 = any may use it
    std::atomic<bool> busy_{false};
};

}  // namespace disparity
