// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include <sys/mman.h>

#include "proto/descriptor.h"

namespace disparityd::proto {

/// A whole file in memory, shared with whoever else maps it, and unmapped at the end.
class Mapping {
public:
    /// `access` as mmap has it. Maps nothing where the system refuses, and errno says why.
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

    /// It is no longer unmapped here.
    void release() { memory_ = MAP_FAILED; }

private:
    void* memory_;
    std::size_t bytes_;
};

}  // namespace disparityd::proto
