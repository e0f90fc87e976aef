// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/post.hpp>

#include "daemon/socket/frames/outgoing_message.h"
#include "proto/tls/tls_stream.h"

namespace disparityd::daemon {

/// The connection to a client, with or without TLS. Reading and waiting are asynchronous; a write takes what goes at
/// once and holds no address of what it was given. The server's thread alone uses it. Without TLS it is the socket.
class ClientStream {
public:
    using Socket = boost::asio::generic::stream_protocol::socket;
    using executor_type = Socket::executor_type;
    using Error = boost::system::error_code;

    /// Without TLS.
    ClientStream(Socket socket) : socket_(std::move(socket)) {}  // NOLINT(google-explicit-constructor)
    /// With TLS, once async_handshake() is done. Throws std::bad_alloc.
    ClientStream(Socket socket, const proto::TlsContext& context);

    executor_type get_executor() { return socket_.get_executor(); }
    void do_not_block() { socket_.non_blocking(true); }
    int native_handle() { return socket_.native_handle(); }
    bool encrypted() const { return tls_ != nullptr; }

    /// The name in the client's certificate; see proto::TlsStream::peer_name().
    std::optional<std::string> certificate() const { return tls_->peer_name(); }

    /// See proto::TlsStream::would_be_taken_by().
    bool would_be_taken_by(const proto::TlsContext& context) const { return tls_->would_be_taken_by(context); }

    /// Calls handler(error) when the handshake has ended. no_tls: the client does not speak TLS; the connection then
    /// goes on without, so that it can be told.
    template <typename Handler>
    void async_handshake(Handler handler);
    static Error no_tls() { return boost::asio::error::operation_not_supported; }

    /// As asio's AsyncReadStream.
    template <typename Buffers, typename Handler>
    void async_read_some(const Buffers& buffers, Handler&& handler);

    /// Reads bytes as they come, encrypted or not, to throw them away.
    template <typename Handler>
    void async_discard(boost::asio::mutable_buffer buffer, Handler handler) {
        socket_.async_read_some(buffer, std::move(handler));
    }

    /// Writes what the socket takes at once. Returns how many bytes; an error of would_block is none.
    std::size_t write_some(const OutgoingMessage::Buffers& buffers, Error& error);

    /// Calls handler(error) when write_some() can go on.
    template <typename Handler>
    void async_wait_writable(Handler handler) {
        socket_.async_wait(write_waits_, std::move(handler));
    }

    /// Tells the client that nothing follows.
    void end_output() noexcept;
    /// Handlers that wait are still called.
    void close() noexcept;

    /// Returns why a call failed, for people.
    std::string reason(const Error& error) const;

private:
    using Outcome = proto::TlsStream::Outcome;

    static Socket::wait_type wait_for(Outcome outcome) {
        return outcome == Outcome::wants_write ? Socket::wait_write : Socket::wait_read;
    }
    static Error error_of(Outcome outcome);
    /// Returns whether the client begins with another protocol; it then has no TLS any more.
    bool begins_without_tls();
    template <typename Handler>
    void shake_hands(Handler handler);
    template <typename Handler>
    void read_tls(boost::asio::mutable_buffer buffer, Handler handler);
    std::size_t write_record(const OutgoingMessage::Buffers& buffers, std::size_t skip, Outcome& outcome);

    Socket socket_;
    std::unique_ptr<proto::TlsStream> tls_;  ///< null: without TLS
    Socket::wait_type write_waits_ = Socket::wait_write;
};

template <typename Handler>
void ClientStream::async_handshake(Handler handler) {
    socket_.async_wait(Socket::wait_read, [this, handler = std::move(handler)](Error error) mutable {
        if (!error && begins_without_tls()) {
            error = no_tls();
        }
        if (error) {
            handler(error);
        } else {
            shake_hands(std::move(handler));
        }
    });
}

template <typename Handler>
void ClientStream::shake_hands(Handler handler) {
    const Outcome outcome = tls_->handshake();
    if (!proto::TlsStream::is_wanting(outcome)) {
        handler(error_of(outcome));
        return;
    }
    socket_.async_wait(wait_for(outcome), [this, handler = std::move(handler)](const Error& error) mutable {
        if (error) {
            handler(error);
        } else {
            shake_hands(std::move(handler));
        }
    });
}

template <typename Buffers, typename Handler>
void ClientStream::async_read_some(const Buffers& buffers, Handler&& handler) {
    if (tls_) {
        read_tls(*boost::asio::buffer_sequence_begin(buffers), std::forward<Handler>(handler));
    } else {
        socket_.async_read_some(buffers, std::forward<Handler>(handler));
    }
}

template <typename Handler>
void ClientStream::read_tls(boost::asio::mutable_buffer buffer, Handler handler) {
    std::size_t received = 0;
    const Outcome outcome = buffer.size() == 0
                                ? Outcome::done
                                : tls_->read({static_cast<std::uint8_t*>(buffer.data()), buffer.size()}, received);
    if (!proto::TlsStream::is_wanting(outcome)) {
        boost::asio::post(get_executor(), [handler = std::move(handler), error = error_of(outcome),
                                           received]() mutable { handler(error, received); });
        return;
    }
    socket_.async_wait(wait_for(outcome), [this, buffer, handler = std::move(handler)](const Error& error) mutable {
        if (error) {
            handler(error, 0);
        } else {
            read_tls(buffer, std::move(handler));
        }
    });
}

}  // namespace disparityd::daemon
