// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "clients/cpp/transport.h"
#include "proto/framing.h"

namespace disparity {

/// Sends and receives whole messages over a transport. It joins a message that arrives in pieces over several calls.
/// Memory grows with the bytes that have arrived, not with the length that a message claims.
class MessageStream {
public:
    using Outcome = Transport::Outcome;

    /// Connects as Transport does.
    MessageStream(const std::string& address, Deadline deadline, const ConnectOptions& options = {})
        : transport_(address, deadline, options) {}

    /// Waits for the next message. Throws std::invalid_argument when it breaks the protocol; the connection is then
    /// closed.
    Outcome receive(Deadline deadline);

    /// Returns the message of the last receive() that was `done`; valid until the next receive().
    const disparityd::v1::Envelope& envelope() const { return envelope_; }
    const std::vector<std::uint8_t>& payload() const { return payload_; }

    /// Sends a message without payload. After a timeout the connection is closed. Where the other side has closed it
    /// already, receive() still returns the messages sent before.
    Outcome send(const disparityd::v1::Envelope& envelope, Deadline deadline);

    /// Return what Transport knows of the connection.
    const std::string& why_closed() const { return transport_.why_closed(); }
    std::int64_t heard_ns() const { return transport_.heard_ns(); }
    std::int64_t empty_ns() const { return transport_.empty_ns(); }
    bool is_private() const { return transport_.is_private(); }
    std::optional<unsigned> server_user() const { return transport_.server_user(); }

private:
    enum class Part { length, envelope, payload };

    Outcome fill(std::vector<std::uint8_t>& buffer, std::uint64_t wanted, Deadline deadline);
    void check_payload() const;

    Transport transport_;
    Part part_ = Part::length;
    std::vector<std::uint8_t> head_;
    std::uint64_t head_wanted_ = disparityd::proto::length_bytes;
    std::vector<std::uint8_t> payload_;
    std::uint64_t filled_ = 0;  ///< bytes of the part that have arrived
    std::vector<std::uint8_t> out_;
    disparityd::v1::Envelope envelope_;
};

}  // namespace disparity
