// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace disparityd {

/// Where a TCP listener binds.
struct TcpAddress {
    std::string host;  ///< a numeric address; "localhost" has become 127.0.0.1
    std::uint16_t port = 0;
};

/// What is wrong with "ADDRESS:PORT" as an address to serve at, as "found ..., allowed: ..."; empty when nothing is.
/// The empty text (no TCP) is fine. An address that other machines can reach is wrong unless `insecure`.
std::string tcp_address_problem(const std::string& text, bool insecure);

/// The parts of a text that has no problem.
TcpAddress parse_tcp_address(const std::string& text);

}  // namespace disparityd
