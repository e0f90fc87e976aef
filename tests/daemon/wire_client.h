// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "proto/disparity.pb.h"

namespace disparityd::test {

/// A client on a bare socket, for what the client library would never do. Blocking, with timeouts.
class WireClient {
public:
    /// "tcp:127.0.0.1:1234" or "unix:/path", as the daemon prints them. Throws std::runtime_error.
    explicit WireClient(const std::string& address);
    virtual ~WireClient();
    WireClient(WireClient&& other) noexcept;
    WireClient& operator=(WireClient&& other) noexcept;

    int descriptor() const { return fd_; }

    /// False when the other end has closed.
    virtual bool send_bytes(std::span<const std::uint8_t> bytes);
    bool send(const v1::Envelope& message);

    /// Sends Hello and returns the answer.
    std::optional<v1::Envelope> hello(const std::string& name = "test", const std::string& token = "");

    /// Asks for a recording, or for the end of it when the path is empty; whether that was granted.
    bool record(const std::string& path);

    struct Message {
        v1::Envelope envelope;
        std::vector<std::uint8_t> payload;
    };

    /// The next message; nothing when the timeout passed or the other end has closed.
    std::optional<Message> receive(std::chrono::milliseconds timeout = std::chrono::seconds(10));

    /// The next frame, other messages left out.
    std::optional<Message> receive_frame(std::chrono::milliseconds timeout = std::chrono::seconds(10));

    /// The next Error, other messages left out; its text, "" when none came.
    std::string receive_error(std::chrono::milliseconds timeout = std::chrono::seconds(10));

    /// Whether the other end closes within the timeout; what still comes is thrown away.
    virtual bool is_closed(std::chrono::milliseconds timeout = std::chrono::seconds(10));

protected:
    virtual bool receive_bytes(std::span<std::uint8_t> bytes, std::chrono::steady_clock::time_point deadline);

private:
    int fd_ = -1;
};

/// Asks for the daemon's status; what comes before it is thrown away. Throws std::runtime_error when none comes.
v1::Status status(WireClient& client);

v1::Envelope subscription(const std::vector<v1::Product>& products);

}  // namespace disparityd::test
