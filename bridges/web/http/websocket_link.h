// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>

#include "bridges/web/http/connections.h"
#include "bridges/web/http/liveness.h"
#include "bridges/web/http/peer_stream.h"
#include "bridges/web/http/routes.h"
#include "bridges/web/live/message_link.h"
#include "bridges/web/live/outgoing.h"

namespace disparityd::web {

/// A WebSocket connection. The operations under way keep it alive.
class WebSocketLink : public MessageLink, public Connection, public std::enable_shared_from_this<WebSocketLink> {
public:
    WebSocketLink(PeerStream&& stream, std::shared_ptr<MessageHandler> handler, Outgoing& outgoing)
        : socket_(std::move(stream)),
          handler_(std::move(handler)),
          outgoing_(outgoing),
          timer_(socket_.get_executor()) {}

    /// Answers the request, and begins. `protocol`: the subprotocol that was agreed on; "" = none.
    void accept(const Request& request, const std::string& protocol);

    void send_text(std::string text) override;
    void send_binary(std::vector<Bytes> parts) override;
    bool busy() const override { return binary_waits_ > 0 || !outgoing_.has_room(std::chrono::steady_clock::now()); }
    void ask_for_answer(std::string mark) override;
    void drop() override { boost::beast::get_lowest_layer(socket_).close(); }
    bool idle() const override { return handler_ == nullptr || handler_->wants_nothing(); }

private:
    using Error = boost::system::error_code;

    enum class Kind { text, binary, ping };

    struct Message {
        Kind kind = Kind::text;
        std::unique_ptr<Outgoing::Load> load;  ///< ends after the parts: their memory is free then
        std::vector<Bytes> parts;              ///< of a ping one: its mark
    };

    /// A peer that reads nothing ends when so many texts wait for it.
    static constexpr std::size_t most_waiting = 256;
    static constexpr std::size_t most_received = 65536;

    void send(Message message);
    void write_next();
    void on_written(Error error);
    void read_next();
    void hear_control(boost::beast::websocket::frame_type kind, boost::beast::string_view payload);
    void look_after_a_while();
    void end();

    boost::beast::websocket::stream<PeerStream> socket_;
    std::shared_ptr<MessageHandler> handler_;  ///< nullptr after the end
    boost::beast::flat_buffer received_;
    std::deque<Message> waiting_;  ///< the first one is being written
    Outgoing& outgoing_;
    boost::asio::steady_timer timer_;
    Liveness liveness_{std::chrono::steady_clock::now()};
    std::size_t binary_waits_ = 0;
    bool closing_ = false;
};

}  // namespace disparityd::web
