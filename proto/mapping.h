// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include <sys/mman.h>

#include "proto/descriptor.h"

namespace disparityd::proto {

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
