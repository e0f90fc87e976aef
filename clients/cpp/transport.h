// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace disparity {

using Deadline = std::chrono::steady_clock::time_point;

/// Returns now plus the timeout. A negative timeout counts as 0, one of more than a year as a year.
Deadline after(std::chrono::milliseconds timeout);

/// Wraps a connected stream socket that never blocks longer than asked. Owns its descriptor.
class Transport {
public:
    enum class Outcome { done, timeout, closed };

    /// Connects to "tcp:HOST:PORT" (IPv6 in brackets) or "unix:PATH". Throws std::invalid_argument for another form,
    /// std::runtime_error when no process accepts.
    Transport(const std::string& address, Deadline deadline);
    ~Transport();
    Transport(const Transport&) = delete;
    Transport& operator=(const Transport&) = delete;

    /// Sends everything, or returns why not. After a timeout only a part of the message has been sent.
    Outcome send(std::span<const std::uint8_t> bytes, Deadline deadline);

    /// Receives the bytes that are there, at least one, and sets `received` to their number.
    Outcome receive(std::span<std::uint8_t> bytes, std::size_t& received, Deadline deadline);

    void close();

    /// Returns the user id of the process that listens at the other end, as the system knows it; nothing over TCP.
    std::optional<unsigned> server_user() const;

private:
    int fd_ = -1;
};

}  // namespace disparity
