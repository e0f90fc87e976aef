// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace disparityd::daemon {

/// The address and port that a TCP listener binds.
struct TcpAddress {
    std::string host;  ///< a numeric address; "localhost" is replaced by 127.0.0.1
    std::uint16_t port = 0;
};

/// Returns why "ADDRESS:PORT" is no address to serve at, as "found ..., allowed: ..."; empty if it is one. The empty
/// text (no TCP) is allowed. An address that other machines can reach is allowed only if `protected_by_tls`: over TLS,
/// to clients with a token or a certificate; or if the user says so (`insecure`).
std::string tcp_address_problem(const std::string& text, bool protected_by_tls, bool insecure);

/// Parses a text for which tcp_address_problem() is empty.
TcpAddress parse_tcp_address(const std::string& text);

}  // namespace disparityd::daemon
