// SPDX-License-Identifier: Apache-2.0
#include "tests/daemon/tls_wire_client.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <fcntl.h>
#include <poll.h>

namespace disparityd::test {
namespace {

using std::chrono::steady_clock;

constexpr std::chrono::seconds patience{60};

}  // namespace

TlsWireClient::TlsWireClient(const std::string& address, const proto::TlsFiles& files, const std::string& server_name)
    : WireClient(address),
      tls_(std::make_unique<proto::TlsStream>(proto::make_client_tls(files), descriptor(),
                                              proto::TlsStream::End::client)) {
    ::fcntl(descriptor(), F_SETFL, O_NONBLOCK);
    tls_->expect_server(server_name);
    const auto deadline = steady_clock::now() + patience;
    Outcome outcome = tls_->handshake();
    while (outcome == Outcome::wants_read || outcome == Outcome::wants_write) {
        outcome = wait(outcome, deadline) ? tls_->handshake() : Outcome::closed;
    }
    if (outcome != Outcome::done) {
        throw std::runtime_error(outcome == Outcome::failed ? tls_->problem() : "closed");
    }
}

bool TlsWireClient::wait(Outcome outcome, steady_clock::time_point deadline) const {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - steady_clock::now());
    pollfd event{descriptor(), static_cast<short>(outcome == Outcome::wants_write ? POLLOUT : POLLIN), 0};
    return ::poll(&event, 1, static_cast<int>(std::max<std::int64_t>(0, left.count()))) > 0;
}

bool TlsWireClient::send_bytes(std::span<const std::uint8_t> bytes) {
    const auto deadline = steady_clock::now() + patience;
    while (!bytes.empty()) {
        std::size_t sent = 0;
        const Outcome outcome = tls_->write(bytes, sent);
        bytes = bytes.subspan(sent);
        const bool waits = outcome == Outcome::wants_read || outcome == Outcome::wants_write;
        if (waits ? !wait(outcome, deadline) : outcome != Outcome::done) {
            return false;
        }
    }
    return true;
}

bool TlsWireClient::receive_bytes(std::span<std::uint8_t> bytes, steady_clock::time_point deadline) {
    while (!bytes.empty()) {
        std::size_t received = 0;
        const Outcome outcome = tls_->read(bytes, received);
        bytes = bytes.subspan(received);
        const bool waits = outcome == Outcome::wants_read || outcome == Outcome::wants_write;
        if (waits ? !wait(outcome, deadline) : outcome != Outcome::done) {
            return false;
        }
    }
    return true;
}

bool TlsWireClient::is_closed(std::chrono::milliseconds timeout) {
    const auto deadline = steady_clock::now() + timeout;
    std::array<std::uint8_t, 4096> ignored{};
    while (steady_clock::now() < deadline) {
        std::size_t received = 0;
        const Outcome outcome = tls_->read(ignored, received);
        if (outcome == Outcome::closed || outcome == Outcome::failed) {
            return true;
        }
        if (outcome != Outcome::done) {
            wait(outcome, deadline);
        }
    }
    return false;
}

}  // namespace disparityd::test
