// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace disparityd::test {

/// Receives datagrams at a port of loopback.
class UdpListener {
public:
    /// How long the tests wait for what must come: far longer than a slow machine needs.
    static constexpr std::chrono::seconds patience{60};

    /// Port 0: one of the system's choice. Throws std::runtime_error when the port is taken.
    explicit UdpListener(std::uint16_t port = 0);
    ~UdpListener();
    UdpListener(const UdpListener&) = delete;
    UdpListener& operator=(const UdpListener&) = delete;

    std::uint16_t port() const { return port_; }
    std::string address() const { return "127.0.0.1:" + std::to_string(port_); }

    /// The next datagram; nothing when none has come in time.
    std::optional<std::vector<std::uint8_t>> receive(std::chrono::milliseconds timeout = patience);

    /// Sends bytes to where the last datagram came from.
    void answer(const std::vector<std::uint8_t>& bytes);

private:
    int fd_ = -1;
    std::uint16_t port_ = 0;
    std::vector<std::uint8_t> sender_;
};

}  // namespace disparityd::test
