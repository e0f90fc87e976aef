// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/websocket_link.h"

#include <boost/asio/post.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

namespace disparityd::web {

void WebSocketLink::accept(const Request& request, const std::string& protocol) {
    namespace websocket = boost::beast::websocket;
    boost::beast::get_lowest_layer(socket_).expires_never();
    websocket::stream_base::timeout timeouts{};
    timeouts.handshake_timeout = std::chrono::seconds(10);
    // Beast's own limit begins anew with each message that is written: Liveness has one of what is heard.
    timeouts.idle_timeout = websocket::stream_base::none();
    timeouts.keep_alive_pings = false;
    socket_.set_option(timeouts);
    socket_.set_option(websocket::stream_base::decorator([protocol](websocket::response_type& response) {
        if (!protocol.empty()) {
            response.set(boost::beast::http::field::sec_websocket_protocol, protocol);
        }
    }));
    socket_.read_message_max(most_received);
    socket_.auto_fragment(false);
    const auto kept = std::make_shared<const Request>(request);
    socket_.async_accept(*kept, [self = shared_from_this(), kept](Error error) {
        if (error) {
            self->handler_ = nullptr;
            return;
        }
        // The callback is called by read operations only, and they keep the link alive.
        self->socket_.control_callback(
            [link = self.get()](auto kind, auto payload) { link->hear_control(kind, payload); });
        self->handler_->on_open(*self);
        self->read_next();
        self->look_after_a_while();
    });
}

void WebSocketLink::send_text(std::string text) {
    send({Kind::text, nullptr, {std::make_shared<const std::string>(std::move(text))}});
}

void WebSocketLink::send_binary(std::vector<Bytes> parts) {
    ++binary_waits_;
    std::size_t bytes = 0;
    for (const Bytes& part : parts) {
        bytes += part->size();
    }
    auto load = outgoing_.hold(bytes, std::chrono::steady_clock::now(), [weak = weak_from_this()] {
        if (const auto self = weak.lock()) {
            self->drop();
        }
    });
    send({Kind::binary, std::move(load), std::move(parts)});
}

/// The answer is that to a ping: every WebSocket has it, and it comes when what was sent before has been read.
void WebSocketLink::ask_for_answer(std::string mark) {
    send({Kind::ping, nullptr, {std::make_shared<const std::string>(std::move(mark))}});
}

void WebSocketLink::send(Message message) {
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

void WebSocketLink::write_next() {
    const Message& message = waiting_.front();
    if (message.kind == Kind::ping) {
        const std::string& mark = *message.parts.front();
        socket_.async_ping(boost::beast::websocket::ping_data(mark.data(), mark.size()),
                           [self = shared_from_this()](Error error) { self->on_written(error); });
        return;
    }
    std::vector<boost::asio::const_buffer> buffers;
    for (const Bytes& part : message.parts) {
        buffers.emplace_back(part->data(), part->size());
    }
    socket_.text(message.kind == Kind::text);
    socket_.async_write(buffers, [self = shared_from_this()](Error error, std::size_t) { self->on_written(error); });
}

void WebSocketLink::on_written(Error error) {
    if (error) {
        end();
        return;
    }
    binary_waits_ -= waiting_.front().kind == Kind::binary ? 1 : 0;
    waiting_.pop_front();
    if (!waiting_.empty()) {
        write_next();
    }
    if (const auto handler = handler_) {
        handler->on_sent();
    }
}

/// Takes what is no message: answers to pings, and pings of the peer's, which Beast answers.
void WebSocketLink::hear_control(boost::beast::websocket::frame_type kind, boost::beast::string_view payload) {
    liveness_.heard(std::chrono::steady_clock::now());
    if (kind != boost::beast::websocket::frame_type::pong || payload.empty()) {
        return;
    }
    // Not in the middle of the operation that reads.
    boost::asio::post(socket_.get_executor(),
                      [self = shared_from_this(), mark = std::string(payload.data(), payload.size())] {
                          if (const auto handler = self->handler_) {
                              handler->on_answer(mark);
                          }
                      });
}

/// Ends a peer that is not heard any more or wants nothing, and asks one that has said nothing for a while.
void WebSocketLink::look_after_a_while() {
    timer_.expires_after(Liveness::pause);
    timer_.async_wait([weak = weak_from_this()](Error error) {
        const auto self = weak.lock();
        if (error || !self || !self->handler_) {
            return;
        }
        switch (self->liveness_.look(std::chrono::steady_clock::now())) {
            case Liveness::Verdict::end: self->drop(); return;
            case Liveness::Verdict::ask: self->ask_for_answer({}); break;
            case Liveness::Verdict::well: break;
        }
        self->look_after_a_while();
    });
}

void WebSocketLink::read_next() {
    socket_.async_read(received_, [self = shared_from_this()](Error error, std::size_t) {
        if (error) {
            self->end();
            return;
        }
        self->liveness_.heard(std::chrono::steady_clock::now());
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
        if (!handler->wants_nothing()) {
            self->liveness_.asked();
        }
        self->read_next();
    });
}

/// Tells the handler once.
void WebSocketLink::end() {
    closing_ = true;
    timer_.cancel();
    if (const auto handler = std::exchange(handler_, nullptr)) {
        handler->on_closed();
    }
    drop();
}

}  // namespace disparityd::web
