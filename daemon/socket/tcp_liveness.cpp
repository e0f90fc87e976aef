// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/tcp_liveness.h"

#include <algorithm>
#include <cstddef>

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

namespace disparityd::daemon {
namespace {

/// One answer may be lost. A client that does not read answers each probe within one round trip.
constexpr int unanswered = 3;

void set(int socket, int level, int option, int value) {
    ::setsockopt(socket, level, option, &value, sizeof(value));
}

}  // namespace

void keep_alive(int socket, const TcpLiveness& liveness) {
    set(socket, IPPROTO_TCP, TCP_KEEPIDLE, static_cast<int>(liveness.idle.count()));
    set(socket, IPPROTO_TCP, TCP_KEEPINTVL, static_cast<int>(liveness.interval.count()));
    set(socket, IPPROTO_TCP, TCP_KEEPCNT, liveness.probes);
    set(socket, SOL_SOCKET, SO_KEEPALIVE, 1);
}

bool has_vanished(int socket, const TcpLiveness& liveness) {
    tcp_info info{};
    socklen_t size = sizeof(info);
    if (::getsockopt(socket, IPPROTO_TCP, TCP_INFO, &info, &size) != 0 ||
        size < offsetof(tcp_info, tcpi_last_ack_recv) + sizeof(info.tcpi_last_ack_recv)) {
        return false;  // an emulator does not report it
    }
    const std::chrono::milliseconds silence(info.tcpi_last_ack_recv);
    return std::max<int>(info.tcpi_retransmits, info.tcpi_probes) >= unanswered &&
           silence >= liveness.longest_silence();
}

}  // namespace disparityd::daemon
