// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "clients/cpp/disparity_client.hpp"
#include "proto/tls/tls_stream.h"

namespace disparity {

using Deadline = std::chrono::steady_clock::time_point;

/// Returns now plus the timeout. A negative timeout counts as 0, one of more than a year as a year.
Deadline after(std::chrono::milliseconds timeout);

/// Wraps a connected stream socket, encrypted or not, that never blocks longer than asked. Owns its descriptor.
class Transport {
public:
    enum class Outcome { done, timeout, closed };

    /// Connects to "tcp:HOST:PORT" (IPv6 in brackets), "tls:HOST:PORT" or "unix:PATH"; "//" may follow the colon.
    /// Throws std::invalid_argument for another form and for a file of the options that cannot be used,
    /// std::runtime_error when no process accepts, or the other end is not who it should be.
    Transport(const std::string& address, Deadline deadline, const ConnectOptions& options = {});
    ~Transport();
    Transport(const Transport&) = delete;
    Transport& operator=(const Transport&) = delete;

    /// Sends everything, or returns why not. After a timeout only a part of the message has been sent.
    Outcome send(std::span<const std::uint8_t> bytes, Deadline deadline);

    /// Receives the bytes that are there, at least one, and sets `received` to their number.
    Outcome receive(std::span<std::uint8_t> bytes, std::size_t& received, Deadline deadline);

    void close();

    /// Returns when bytes came last, and when a look at the socket found none; CLOCK_MONOTONIC, 0 = not yet.
    std::int64_t heard_ns() const { return heard_ns_; }
    std::int64_t empty_ns() const { return empty_ns_; }

    /// Returns one line: why the connection was closed, where TLS says it; else an empty text.
    const std::string& why_closed() const { return why_closed_; }

    /// Returns whether nobody on the way can read what is sent: over TLS, or to this machine.
    bool is_private() const;

    /// Returns the user id of the process that listens at the other end, as the system knows it; nothing over TCP.
    std::optional<unsigned> server_user() const;

private:
    void begin_tls(const std::string& address, Deadline deadline, const ConnectOptions& options);
    bool wait(disparityd::proto::TlsStream::Outcome outcome, Deadline deadline) const;
    Outcome end_of(disparityd::proto::TlsStream::Outcome outcome);
    Outcome send_tls(std::span<const std::uint8_t> bytes, Deadline deadline);
    Outcome receive_tls(std::span<std::uint8_t> bytes, std::size_t& received, Deadline deadline);

    int fd_ = -1;
    std::int64_t heard_ns_ = 0;
    std::int64_t empty_ns_ = 0;
    std::unique_ptr<disparityd::proto::TlsStream> tls_;  ///< null: not encrypted
    std::string why_closed_;
};

}  // namespace disparity
