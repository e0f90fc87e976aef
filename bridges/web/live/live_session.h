// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <boost/asio/steady_timer.hpp>

#include "bridges/web/daemon/hub.h"
#include "bridges/web/live/encoding_turns.h"
#include "bridges/web/live/frame_pace.h"
#include "bridges/web/live/live_message.h"
#include "bridges/web/live/message_link.h"
#include "bridges/web/live/outgoing.h"
#include "bridges/web/metrics/web_counters.h"

namespace disparityd::web {

/// What all connections of the server share.
struct ServerParts {
    boost::asio::io_context& network;  ///< one thread: sockets, hubs, sessions
    EncodingTurns& encoding;           ///< one thread: images
    Outgoing& outgoing;
    WebCounters& counters;
};

/// Where the connections to one daemon do their work.
struct Workplace : ServerParts {
    Hub& hub;
};

/// One page: what it asks for, and what it is told. docs/web.md defines the messages.
class LiveSession : public MessageHandler, public Listener, public std::enable_shared_from_this<LiveSession> {
public:
    /// `peer`: the visitor's address.
    LiveSession(const Workplace& workplace, std::string peer)
        : place_(workplace), peer_(std::move(peer)), timer_(workplace.network) {}

    void on_open(MessageLink& link) override;
    void on_text(std::string_view text) override;
    void on_binary() override { handle(WrongMessage{"a message is binary; allowed: text"}); }
    void on_sent() override { send_next(); }
    void on_closed() override;
    bool wants_nothing() const override { return !subscription_.wants_frames() && !subscription_.sensors; }

    void on_frame(const std::shared_ptr<const LiveFrame>& frame) override;
    void on_state(const DaemonState& state) override;
    void on_sensors(const disparity::SensorBatch& batch) override;
    Wants wants() const override;

private:
    void handle(const LiveSubscription& subscription);
    void handle(const Seen& seen);
    void handle(const Point& point);
    void handle(const WrongMessage& wrong);
    void greet(const DaemonState& state);
    void send_next();
    void wait_for_rate();
    int scale() const;
    std::vector<ImageView> views() const;
    void send(const LiveFrame& live, const std::vector<Bytes>& parts, std::uint64_t skipped);

    Workplace place_;
    std::string peer_;
    MessageLink* link_ = nullptr;  ///< nullptr after the end
    LiveSubscription subscription_;
    Point point_;
    FramePace pace_;
    LinkFacts facts_;
    std::vector<disparity::Product> told_products_;
    boost::asio::steady_timer timer_;
    std::shared_ptr<const LiveFrame> waiting_;  ///< the newest frame that was not sent
    std::uint64_t passed_ = 0;                  ///< frames that came since the last one that was sent
    bool encoding_ = false;
    std::chrono::steady_clock::time_point sensors_next_{};
};

}  // namespace disparityd::web
