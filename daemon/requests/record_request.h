// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace disparityd::daemon {

/// What a client wants to have recorded, and who it is.
struct RecordRequest {
    std::string path;          ///< as the client wrote it
    bool owner = false;        ///< ClientPeer::owns_daemon()
    std::uint64_t client = 0;  ///< the connection's number
};

}  // namespace disparityd::daemon
