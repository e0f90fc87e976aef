// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cerrno>
#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <string>

#include <sys/eventfd.h>
#include <unistd.h>

namespace disparityd::base {

/// Wakes a thread that sleeps in poll(), by an eventfd. Any thread may call wake(), the sleeping thread the rest.
class Waker {
public:
    Waker() : descriptor_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
        if (descriptor_ < 0) {
            throw std::runtime_error("cannot make an eventfd (error " + std::to_string(errno) +
                                     "): raise the limit of open files (LimitNOFILE=, ulimit -n)");
        }
    }
    ~Waker() { ::close(descriptor_); }
    Waker(const Waker&) = delete;
    Waker& operator=(const Waker&) = delete;

    void wake() noexcept {
        const std::uint64_t one = 1;
        [[maybe_unused]] const auto written = ::write(descriptor_, &one, sizeof one);
    }

    void clear() noexcept {
        std::uint64_t count = 0;
        [[maybe_unused]] const auto read = ::read(descriptor_, &count, sizeof count);
    }

    /// Returns a descriptor that is readable from wake() to clear().
    int descriptor() const { return descriptor_; }

private:
    int descriptor_;
};

/// Why wait_for_device() returned. All false: the deadline has passed, or a signal came.
struct Wakening {
    bool woken = false;     ///< by the waker, which is cleared
    bool readable = false;  ///< the device has something to read
    bool failed = false;    ///< the device has an error or is gone
};

/// Sleeps until the device has something to say, the waker is woken or the deadline passes, at most a minute.
/// `device` is a descriptor, or -1 for none. Called by the thread that owns the waker.
Wakening wait_for_device(int device, Waker& waker, std::chrono::steady_clock::time_point deadline);

}  // namespace disparityd::base
