// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace disparityd::base {

/// Sets how the GNU C library keeps freed memory; does nothing with another library. A daemon runs for months, and
/// every reload allocates a whole engine and frees the old one.
///
/// By default, the library raises its mmap threshold to the size of the largest freed mapping (32 MiB at most): later
/// allocations of that size stay in a heap instead of going back to the system. It also makes heaps (arenas) for
/// threads and keeps them. So the threshold is fixed, above the size of what is allocated for each frame, and the
/// arenas are few: no frame allocates between capture and shared memory, so no thread waits for an arena. To be called
/// before other threads start.
void set_up_freed_memory();

/// Gives the free memory of the heaps back to the system. Takes some milliseconds, in which threads that allocate wait.
void give_back_freed_memory();

}  // namespace disparityd::base
