// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "base/memory_room.h"
#include "capture/frame_source.h"
#include "daemon/config/config.h"
#include "daemon/published_frame.h"

namespace disparityd::daemon {

/// The most memory that a configuration makes the daemon hold, in bytes. docs/operations.md says how each comes about.
struct MemoryBounds {
    std::size_t engine = 0;          ///< the program, source and matcher, and what is kept for all else
    std::size_t frames = 0;          ///< what serves frames: shared memory, and copies for the sockets
    std::size_t clients = 0;         ///< of `places` clients, none of which reads what it is sent
    std::size_t system = 0;          ///< what the system keeps for the sockets of these
    std::size_t recording = 0;       ///< one, whose disk is slow
    std::size_t places = 0;          ///< how many clients there may be, those that are being refused included
    std::size_t places_refused = 0;  ///< of which these are for clients that are told that there is no place

    std::size_t all() const { return engine + frames + clients + system + recording; }

    /// Returns a line for people: "memory at most: 1077 MB: matching 261 MB, frames 20 MB, ...".
    std::string text() const;

    /// Returns a line for people where the room is too small for all, with the number of clients for which it is not;
    /// empty where it suffices. `room`: as it is when the engine has its memory.
    std::string warning(const base::MemoryRoom& room) const;
};

/// Returns what serving frames of this layout, clients and a recording of this source take beside the engine. Any
/// thread.
MemoryBounds serving_memory(const Config& config, const StreamLayout& layout, const capture::SourceInfo& source);

}  // namespace disparityd::daemon
