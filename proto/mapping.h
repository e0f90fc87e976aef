// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include <sys/mman.h>
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

/// Maps a whole file into memory, shared with other processes, and unmaps it at the end.
class Mapping {
public:
    /// `access` is the protection of mmap. Where the system refuses, nothing is mapped and errno has the reason.
    Mapping(const Descriptor& file, std::size_t bytes, int access)
        : memory_(::mmap(nullptr, bytes, access, MAP_SHARED, file.get(), 0)), bytes_(bytes) {}
    ~Mapping() {
        if (*this) {
            ::munmap(memory_, bytes_);
        }
    }
    Mapping(const Mapping&) = delete;
    Mapping& operator=(const Mapping&) = delete;
    explicit operator bool() const { return memory_ != MAP_FAILED; }

    template <typename T>
    T& start() const {
        return *static_cast<T*>(memory_);
    }

private:
    void* memory_;
    std::size_t bytes_;
};

}  // namespace disparityd::proto
