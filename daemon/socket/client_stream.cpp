// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/client_stream.h"

#include <algorithm>
#include <cstring>

#include <sys/socket.h>

namespace disparityd::daemon {
namespace {

namespace asio = boost::asio;

/// So much is encrypted for one client before others get their turn.
constexpr std::size_t most_at_once = std::size_t{1} << 20;

}  // namespace

ClientStream::ClientStream(Socket socket, const proto::TlsContext& context) : socket_(std::move(socket)) {
    tls_ = std::make_unique<proto::TlsStream>(context, socket_.native_handle(), proto::TlsStream::End::server);
}

ClientStream::Error ClientStream::error_of(Outcome outcome) {
    switch (outcome) {
        case Outcome::done: return {};
        case Outcome::closed: return asio::error::eof;
        default: return asio::error::connection_aborted;
    }
}

bool ClientStream::begins_without_tls() {
    std::array<std::uint8_t, 2> bytes{};
    if (::recv(socket_.native_handle(), bytes.data(), bytes.size(), MSG_PEEK) < static_cast<ssize_t>(bytes.size()) ||
        proto::begins_with_tls(bytes)) {
        return false;
    }
    tls_.reset();
    return true;
}

/// Writes one record: of the first part when that is long, else of as many parts as there is room for, so that the head
/// of a frame is no record and no packet of its own.
std::size_t ClientStream::write_record(const OutgoingMessage::Buffers& buffers, std::size_t skip, Outcome& outcome) {
    constexpr std::size_t most = proto::TlsStream::record_bytes;
    std::array<std::uint8_t, most>
        gathered;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled as far as it is used
    std::size_t filled = 0;
    std::size_t sent = 0;
    for (const asio::const_buffer& part : buffers) {
        const std::size_t skipped = std::min(skip, part.size());
        skip -= skipped;
        const auto* const from = static_cast<const std::uint8_t*>(part.data()) + skipped;
        const std::size_t length = part.size() - skipped;
        if (filled == 0 && length >= most) {
            outcome = tls_->write({from, most}, sent);
            return sent;
        }
        const std::size_t taken = std::min(length, most - filled);
        if (taken != 0) {
            std::memcpy(gathered.data() + filled, from, taken);
            filled += taken;
        }
    }
    outcome = filled == 0 ? Outcome::done : tls_->write({gathered.data(), filled}, sent);
    return sent;
}

std::size_t ClientStream::write_some(const OutgoingMessage::Buffers& buffers, Error& error) {
    error = {};
    if (!tls_) {
        return socket_.write_some(buffers, error);
    }
    const std::size_t all = asio::buffer_size(buffers);
    std::size_t sent = 0;
    write_waits_ = Socket::wait_write;
    while (sent < std::min(all, most_at_once)) {
        Outcome outcome{};
        sent += write_record(buffers, sent, outcome);
        if (outcome != Outcome::done) {
            write_waits_ = wait_for(outcome);
            error = proto::TlsStream::is_wanting(outcome) ? Error(asio::error::would_block) : error_of(outcome);
            break;
        }
    }
    return sent;
}

void ClientStream::end_output() noexcept {
    if (tls_) {
        tls_->end_output();
    }
    Error ignored;
    socket_.shutdown(Socket::shutdown_send, ignored);
}

void ClientStream::close() noexcept {
    if (tls_) {
        tls_->leave_socket();  // a handler that is on its way still calls it
    }
    Error ignored;
    socket_.close(ignored);
}

std::string ClientStream::reason(const Error& error) const {
    return tls_ && error == asio::error::connection_aborted && !tls_->problem().empty() ? "TLS: " + tls_->problem()
                                                                                        : error.message();
}

}  // namespace disparityd::daemon
