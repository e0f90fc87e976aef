// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/post.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "bridges/web/http/connections.h"
#include "bridges/web/http/routes.h"
#include "bridges/web/live/message_link.h"

namespace disparityd::web {

/// A WebSocket connection. `Stream` is a TCP stream with or without TLS. The operations under way keep it alive.
template <typename Stream>
class WebSocketLink : public MessageLink,
                      public Connection,
                      public std::enable_shared_from_this<WebSocketLink<Stream>> {
public:
    WebSocketLink(Stream&& stream, std::shared_ptr<MessageHandler> handler)
        : socket_(std::move(stream)), handler_(std::move(handler)) {}

    /// Answers the request, and begins. `protocol`: the subprotocol that was agreed on; "" = none.
    void accept(const Request& request, const std::string& protocol);

    void send_text(std::string text) override;
    void send_binary(std::vector<Bytes> parts) override;
    bool busy() const override { return binary_waits_ > 0; }
    void drop() override { boost::beast::get_lowest_layer(socket_).close(); }
    bool idle() const override { return false; }

private:
    using Error = boost::system::error_code;

    struct Message {
        bool text = false;
        std::vector<Bytes> parts;
    };

    /// A peer that reads nothing ends when so many texts wait for it.
    static constexpr std::size_t most_waiting = 256;
    static constexpr std::size_t most_received = 65536;

    void send(Message message);
    void write_next();
    void read_next();
    void end();

    boost::beast::websocket::stream<Stream> socket_;
    std::shared_ptr<MessageHandler> handler_;  ///< nullptr after the end
    boost::beast::flat_buffer received_;
    std::deque<Message> waiting_;  ///< the first one is being written
    std::size_t binary_waits_ = 0;
    bool closing_ = false;
};

template <typename Stream>
void WebSocketLink<Stream>::accept(const Request& request, const std::string& protocol) {
    namespace websocket = boost::beast::websocket;
    boost::beast::get_lowest_layer(socket_).expires_never();
    websocket::stream_base::timeout timeouts{};
    timeouts.handshake_timeout = std::chrono::seconds(10);
    // A ping waits behind the frame that is on its way out: over a slow link that may take long.
    timeouts.idle_timeout = std::chrono::seconds(60);
    timeouts.keep_alive_pings = true;
    socket_.set_option(timeouts);
    socket_.set_option(websocket::stream_base::decorator([protocol](websocket::response_type& response) {
        if (!protocol.empty()) {
            response.set(boost::beast::http::field::sec_websocket_protocol, protocol);
        }
    }));
    socket_.read_message_max(most_received);
    socket_.auto_fragment(false);
    const auto kept = std::make_shared<const Request>(request);
    socket_.async_accept(*kept, [self = this->shared_from_this(), kept](Error error) {
        if (error) {
            self->handler_ = nullptr;
            return;
        }
        self->handler_->on_open(*self);
        self->read_next();
    });
}

template <typename Stream>
void WebSocketLink<Stream>::send_text(std::string text) {
    send({true, {std::make_shared<const std::string>(std::move(text))}});
}

template <typename Stream>
void WebSocketLink<Stream>::send_binary(std::vector<Bytes> parts) {
    ++binary_waits_;
    send({false, std::move(parts)});
}

template <typename Stream>
void WebSocketLink<Stream>::send(Message message) {
    if (closing_) {
        return;
    }
    if (waiting_.size() >= most_waiting) {
        closing_ = true;
        drop();  // the operations under way end with an error, and the handler is told
        return;
    }
    waiting_.push_back(std::move(message));
    if (waiting_.size() == 1) {
        write_next();
    }
}

template <typename Stream>
void WebSocketLink<Stream>::write_next() {
    const Message& message = waiting_.front();
    std::vector<boost::asio::const_buffer> buffers;
    for (const Bytes& part : message.parts) {
        buffers.emplace_back(part->data(), part->size());
    }
    socket_.text(message.text);
    socket_.async_write(buffers, [self = this->shared_from_this()](Error error, std::size_t) {
        if (error) {
            self->end();
            return;
        }
        self->binary_waits_ -= self->waiting_.front().text ? 0 : 1;
        self->waiting_.pop_front();
        if (!self->waiting_.empty()) {
            self->write_next();
        }
        if (const auto handler = self->handler_) {
            handler->on_sent();
        }
    });
}

template <typename Stream>
void WebSocketLink<Stream>::read_next() {
    socket_.async_read(received_, [self = this->shared_from_this()](Error error, std::size_t) {
        if (error) {
            self->end();
            return;
        }
        const auto handler = self->handler_;  // lives through the call, whatever it does to the link
        if (!handler) {
            return;
        }
        if (!self->socket_.got_text()) {
            self->received_.consume(self->received_.size());
            handler->on_binary();
            self->read_next();
            return;
        }
        const auto data = self->received_.data();
        const std::string text(static_cast<const char*>(data.data()), data.size());
        self->received_.consume(self->received_.size());
        handler->on_text(text);
        self->read_next();
    });
}

/// Tells the handler once.
template <typename Stream>
void WebSocketLink<Stream>::end() {
    closing_ = true;
    if (const auto handler = std::exchange(handler_, nullptr)) {
        handler->on_closed();
    }
    drop();
}

}  // namespace disparityd::web
