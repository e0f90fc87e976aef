// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace disparityd::web {

/// What the web server counts about itself. All but `clients` are counts since its start, which never fall.
struct WebCounters {
    std::uint64_t clients = 0;  ///< pages and viewers that get frames, now
    std::uint64_t bytes_sent = 0;
    std::uint64_t frames_sent = 0;     ///< to all clients together
    std::uint64_t frames_skipped = 0;  ///< not sent to a client that was too slow or wanted fewer
    std::uint64_t requests = 0;        ///< of HTTP, refused ones among them
    std::uint64_t refused = 0;         ///< answered by a status of 400 or more
};

}  // namespace disparityd::web
