// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <utility>

#include <boost/asio/async_result.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/beast/core/basic_stream.hpp>
#include <boost/beast/core/role.hpp>

namespace disparityd::web {

/// A few buffers of an operation, which need not do all of them: Asio's composed operations come back with the rest.
template <typename Buffer>
class FewBuffers {
public:
    using value_type = Buffer;

    template <typename Sequence>
    explicit FewBuffers(const Sequence& buffers) {
        const auto last = boost::asio::buffer_sequence_end(buffers);
        for (auto each = boost::asio::buffer_sequence_begin(buffers); each != last && count_ < buffers_.size();
             ++each) {
            const Buffer buffer(*each);
            if (buffer.size() > 0) {
                buffers_[count_++] = buffer;
            }
        }
    }

    const Buffer* begin() const { return buffers_.data(); }
    const Buffer* end() const { return buffers_.data() + count_; }

private:
    std::array<Buffer, 16> buffers_{};
    std::size_t count_ = 0;
};

/// The bytes of a connection, with TLS or without: one type and functions that are no templates, so that what Beast
/// makes of a stream is compiled once, and not for each kind of it. Models Asio's AsyncReadStream and AsyncWriteStream,
/// and what Beast's WebSockets ask of a stream. One thread uses it at a time, that of its executor.
class PeerStream {
public:
    /// TCP, or for tests one end of a socket pair.
    using Socket = boost::beast::basic_stream<boost::asio::generic::stream_protocol>;
    using executor_type = Socket::executor_type;
    using Error = boost::system::error_code;
    using Done = std::function<void(Error)>;
    using Moved = std::function<void(Error, std::size_t)>;

    /// Without TLS.
    explicit PeerStream(Socket::socket_type socket);
    /// The server's end of TLS, whose handshake is still to come. `context` lives longer than the stream.
    PeerStream(Socket::socket_type socket, boost::asio::ssl::context& context);
    ~PeerStream();
    PeerStream(PeerStream&&) noexcept;
    PeerStream& operator=(PeerStream&&) noexcept;

    executor_type get_executor() { return next_layer().get_executor(); }
    /// What has the timeouts, and is closed.
    Socket& next_layer();

    /// Calls `done` after TLS's handshake; without TLS before it returns.
    void shake_hands(Done done);

    template <typename Buffers, typename Handler>
    auto async_read_some(const Buffers& buffers, Handler&& handler) {
        return begin(&PeerStream::read_some, FewBuffers<boost::asio::mutable_buffer>(buffers), handler);
    }

    template <typename Buffers, typename Handler>
    auto async_write_some(const Buffers& buffers, Handler&& handler) {
        return begin(&PeerStream::write_some, FewBuffers<boost::asio::const_buffer>(buffers), handler);
    }

    /// Beast ends the stream under a WebSocket with this.
    template <typename Handler>
    friend void async_teardown(boost::beast::role_type role, PeerStream& stream, Handler&& handler) {
        stream.tear_down(role, kept<Done>(std::forward<Handler>(handler)));
    }

private:
    class Tls;

    /// Handlers can be moved only, functions are copied.
    template <typename Function, typename Handler>
    static Function kept(Handler&& handler) {
        return [kept = std::make_shared<std::decay_t<Handler>>(std::forward<Handler>(handler))](auto... results) {
            std::move (*kept)(results...);
        };
    }

    template <typename Buffer, typename Handler>
    auto begin(void (PeerStream::*operation)(const FewBuffers<Buffer>&, Moved), const FewBuffers<Buffer>& buffers,
               Handler& handler) {
        return boost::asio::async_initiate<Handler, void(Error, std::size_t)>(
            [this, operation](auto&& handler, const FewBuffers<Buffer>& few) {
                (this->*operation)(few, kept<Moved>(std::forward<decltype(handler)>(handler)));
            },
            handler, buffers);
    }

    void read_some(const FewBuffers<boost::asio::mutable_buffer>& buffers, Moved done);
    void write_some(const FewBuffers<boost::asio::const_buffer>& buffers, Moved done);
    void tear_down(boost::beast::role_type role, Done done);

    std::unique_ptr<Socket> plain_;  ///< nullptr: with TLS
    std::unique_ptr<Tls> tls_;
};

}  // namespace disparityd::web
