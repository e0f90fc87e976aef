// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cerrno>
#include <cstdint>
#include <stdexcept>
#include <string>

#include <sys/eventfd.h>
#include <unistd.h>

namespace disparityd::capture {

/// Wakes a thread that sleeps in poll(): an eventfd. wake() from any thread, the rest by the thread that sleeps.
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

    /// Readable from wake() to clear().
    int descriptor() const { return descriptor_; }

private:
    int descriptor_;
};

}  // namespace disparityd::capture
