// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace disparity {

using Deadline = std::chrono::steady_clock::time_point;

/// Now plus the timeout; negative ones count as 0, very long ones as a year.
Deadline after(std::chrono::milliseconds timeout);

/// A connected stream socket that never blocks longer than asked. Owns its descriptor.
class Transport {
public:
    enum class Outcome { done, timeout, closed };

    /// "tcp:HOST:PORT" (IPv6 in brackets) or "unix:PATH". Throws std::invalid_argument for another form,
    /// std::runtime_error when nobody answers.
    Transport(const std::string& address, Deadline deadline);
    ~Transport();
    Transport(const Transport&) = delete;
    Transport& operator=(const Transport&) = delete;

    /// Sends everything, or says why not; after a timeout the stream is cut in the middle of a message.
    Outcome send(std::span<const std::uint8_t> bytes, Deadline deadline);

    /// Receives what is there, at least one byte; `received` says how many.
    Outcome receive(std::span<std::uint8_t> bytes, std::size_t& received, Deadline deadline);

    void close();

private:
    int fd_ = -1;
};

}  // namespace disparity
