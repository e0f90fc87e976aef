// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/steady_timer.hpp>

#include "bridges/web/http/connections.h"
#include "bridges/web/http/peer_stream.h"
#include "bridges/web/live/message_link.h"
#include "bridges/web/live/outgoing.h"

namespace disparityd::web {

/// A response without end: each binary message is written as it is, after the head of the response. A message is out
/// when the peer's system has acknowledged all of it: what waits in this one would be old when it arrives. The
/// operations under way keep it alive.
class MultipartLink : public MessageLink, public Connection, public std::enable_shared_from_this<MultipartLink> {
public:
    MultipartLink(PeerStream&& stream, std::shared_ptr<MessageHandler> handler, Outgoing& outgoing)
        : stream_(std::move(stream)),
          handler_(std::move(handler)),
          outgoing_(outgoing),
          timer_(stream_.get_executor()) {}

    /// Writes the head of the response, and begins.
    void start(const std::string& head);

    void send_text(std::string /*text*/) override {}  // it has no place between the parts
    void send_binary(std::vector<Bytes> parts) override;
    bool busy() const override { return sending_ || !outgoing_.has_room(Clock::now()); }
    void ask_for_answer(std::string /*mark*/) override {}  // HTTP has none
    void drop() override { boost::beast::get_lowest_layer(stream_).close(); }
    bool idle() const override { return false; }

private:
    using Clock = std::chrono::steady_clock;
    using Error = boost::system::error_code;
    /// A peer that does not take a message within this time is ended.
    static constexpr std::chrono::seconds patience{20};
    static constexpr std::chrono::milliseconds shortest_look{1};
    static constexpr std::chrono::milliseconds longest_look{20};

    void watch();
    void on_written(Error error);
    void wait_until_acknowledged(std::chrono::milliseconds pause);
    void end();

    PeerStream stream_;
    std::shared_ptr<MessageHandler> handler_;  ///< nullptr after the end
    Outgoing& outgoing_;
    boost::asio::steady_timer timer_;
    std::vector<Bytes> written_;  ///< what is on its way out of this program
    std::unique_ptr<Outgoing::Load> load_;
    bool sending_ = false;
    Clock::time_point deadline_;
    char unread_ = 0;
};

}  // namespace disparityd::web
