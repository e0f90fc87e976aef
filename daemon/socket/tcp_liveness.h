// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace disparityd::daemon {

/// When a TCP connection counts as lost because the other machine, or the network, no longer answers. The system of a
/// client that does not read still answers probes.
struct TcpLiveness {
    std::chrono::seconds idle{20};     ///< without traffic before the first probe
    std::chrono::seconds interval{5};  ///< between probes
    int probes = 4;                    ///< without an answer

    std::chrono::seconds longest_silence() const { return idle + probes * interval; }
};

/// Turns on keep-alive probes, which the system sends while no data is unacknowledged.
void keep_alive(int socket, const TcpLiveness& liveness);

/// Returns whether data has been retransmitted without an answer for longest_silence(). The system sends no keep-alive
/// probes while data is unacknowledged, and gives up only after about 15 minutes. TCP_USER_TIMEOUT would be shorter,
/// but also ends connections of clients that do not read.
bool has_vanished(int socket, const TcpLiveness& liveness);

}  // namespace disparityd::daemon
