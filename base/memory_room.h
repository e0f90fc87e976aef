// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace disparityd::base {

/// Memory that this process may still take. The system promises more than it has, and ends a process that uses it.
struct MemoryRoom {
    std::size_t bytes = SIZE_MAX;  ///< SIZE_MAX: not known
    std::string where;             ///< whose it is: "this machine", "control group /system.slice/disparityd.service"
};

/// Returns the least of what the machine has available and what the control groups of this process, of either version,
/// leave it; files in their caches count as free. `root`: the folder with proc/ and sys/, of tests.
MemoryRoom memory_room(const std::string& root = "");

/// What is kept free beside what is asked for: threads, clients and recordings take theirs later.
constexpr std::size_t memory_reserve = 64'000'000;

/// Throws std::runtime_error with one line where matching needs more bytes than there are beside the reserve.
void check_memory_room(std::size_t needed, const MemoryRoom& room);

/// Returns the bytes that this process has in memory at the moment; 0 where the system does not tell.
std::size_t resident_memory();

}  // namespace disparityd::base
