// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "proto/tls/tls_stream.h"
#include "tests/daemon/wire_client.h"

namespace disparityd::test {

/// A client on a bare TLS connection.
class TlsWireClient : public WireClient {
public:
    /// "tls:127.0.0.1:1234", or "tcp:..." for a port that speaks no TLS. Throws std::runtime_error with OpenSSL's
    /// reason when the handshake fails.
    TlsWireClient(const std::string& address, const proto::TlsFiles& files,
                  const std::string& server_name = "127.0.0.1");

    bool send_bytes(std::span<const std::uint8_t> bytes) override;
    bool is_closed(std::chrono::milliseconds timeout) override;

    /// Why the last call failed, where TLS says it.
    const std::string& problem() const { return tls_->problem(); }

protected:
    bool receive_bytes(std::span<std::uint8_t> bytes, std::chrono::steady_clock::time_point deadline) override;

private:
    using Outcome = proto::TlsStream::Outcome;
    bool wait(Outcome outcome, std::chrono::steady_clock::time_point deadline) const;

    std::unique_ptr<proto::TlsStream> tls_;
};

}  // namespace disparityd::test
