// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

namespace disparityd::proto {

/// Owns the descriptor of an open file and closes it. -1 means none.
class Descriptor {
public:
    explicit Descriptor(int fd) : fd_(fd) {}
    ~Descriptor() {
        if (fd_ >= 0) {
            ::close(fd_);
        }
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int get() const { return fd_; }

private:
    int fd_;
};

}  // namespace disparityd::proto
