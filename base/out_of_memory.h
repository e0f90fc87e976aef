// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace disparityd::base {

/// From now on a failed allocation ends this program, with one line on standard error and exit status 1. Queues are
/// bounded, and what matching needs is compared with the machine beforehand, so a small allocation fails only where
/// little can go on; a service manager starts the daemon again. To be called once, before other threads start.
void end_when_out_of_memory();

/// While an object of this class lives, a failed allocation of its thread throws std::bad_alloc instead: for work that
/// takes much memory and can be refused as a whole.
class MemoryMayBeRefused {
public:
    MemoryMayBeRefused();
    ~MemoryMayBeRefused();
    MemoryMayBeRefused(const MemoryMayBeRefused&) = delete;
    MemoryMayBeRefused& operator=(const MemoryMayBeRefused&) = delete;
};

}  // namespace disparityd::base
