// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>

#include "daemon/log.h"
#include "daemon/socket/client_access.h"
#include "daemon/socket/client_stream.h"
#include "daemon/socket/tcp_liveness.h"

namespace disparityd::daemon {

/// Rate limits of log lines about clients, one per kind of line: many lines of one kind do not suppress another kind.
struct ClientLog {
    LogLimiter connections;
    LogLimiter unsubscribed;  ///< of clients that subscribe to nothing
    LogLimiter errors;
    LogLimiter slow_clients;
};

/// Rights and time limits of clients, as configured.
struct ClientRules {
    ClientAccess access;
    proto::TlsContext tls;                      ///< for clients over TCP; null: they use none
    std::chrono::milliseconds idle_timeout{0};  ///< for clients without subscription and request; 0 = unlimited
    TcpLiveness liveness;
    std::chrono::microseconds request_interval{5000};  ///< between two messages of a client, after most_at_once
    static constexpr int most_at_once = 200;
    static constexpr std::size_t bytes_of_one = 4096;  ///< a longer message counts as several
    /// Answers that may wait for a client, and their bytes, before nothing more is read from it.
    static constexpr std::size_t max_answers = 8;
    static constexpr std::size_t max_answer_bytes = 65536;
    /// Between two messages Ready or Ping, after most_at_once; they count as no other message.
    static constexpr std::chrono::microseconds credit_interval{1000};
};

}  // namespace disparityd::daemon
