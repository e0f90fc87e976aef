// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/peer_stream.h"

#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <boost/beast/websocket/teardown.hpp>

namespace disparityd::web {

class PeerStream::Tls : public boost::beast::ssl_stream<PeerStream::Socket> {
    using boost::beast::ssl_stream<PeerStream::Socket>::ssl_stream;
};

PeerStream::PeerStream(Socket::socket_type socket) : plain_(std::make_unique<Socket>(std::move(socket))) {}
PeerStream::PeerStream(Socket::socket_type socket, boost::asio::ssl::context& context)
    : tls_(std::make_unique<Tls>(Socket(std::move(socket)), context)) {}
PeerStream::~PeerStream() = default;
PeerStream::PeerStream(PeerStream&&) noexcept = default;
PeerStream& PeerStream::operator=(PeerStream&&) noexcept = default;

PeerStream::Socket& PeerStream::next_layer() {
    return tls_ ? tls_->next_layer() : *plain_;
}

void PeerStream::shake_hands(Done done) {
    if (tls_) {
        tls_->async_handshake(boost::asio::ssl::stream_base::server, std::move(done));
    } else {
        done({});
    }
}

void PeerStream::read_some(const FewBuffers<boost::asio::mutable_buffer>& buffers, Moved done) {
    if (tls_) {
        tls_->async_read_some(buffers, std::move(done));
    } else {
        plain_->async_read_some(buffers, std::move(done));
    }
}

void PeerStream::write_some(const FewBuffers<boost::asio::const_buffer>& buffers, Moved done) {
    if (tls_) {
        tls_->async_write_some(buffers, std::move(done));
    } else {
        plain_->async_write_some(buffers, std::move(done));
    }
}

void PeerStream::tear_down(boost::beast::role_type role, Done done) {
    using boost::beast::websocket::async_teardown;
    if (tls_) {
        async_teardown(role, static_cast<boost::beast::ssl_stream<Socket>&>(*tls_), std::move(done));
    } else {
        async_teardown(role, *plain_, std::move(done));
    }
}

}  // namespace disparityd::web
