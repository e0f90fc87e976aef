// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

namespace disparityd::bench {

/// Counts what the program asks the system for, all threads, while it lives: malloc and its kin, and anonymous mmap,
/// by whomever they are called, OpenCV included. One at a time.
class AllocationMeter {
public:
    AllocationMeter();
    ~AllocationMeter();
    AllocationMeter(const AllocationMeter&) = delete;
    AllocationMeter& operator=(const AllocationMeter&) = delete;

    /// The most bytes that were held at once beyond what was held at the start; empty where it cannot be counted
    /// (programs built with a sanitizer, which have an allocator of their own).
    std::optional<std::int64_t> peak_bytes() const;
};

}  // namespace disparityd::bench
