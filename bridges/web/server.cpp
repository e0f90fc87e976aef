// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/server.h"

#include <csignal>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>

#include "bridges/web/daemon/frame_feed.h"
#include "bridges/web/daemon/status_feed.h"
#include "bridges/web/http/listener.h"

namespace disparityd::web {

namespace asio = boost::asio;

/// The parts, in the order in which they end: the last one first.
class Server::Impl {
public:
    explicit Impl(const ServerSettings& settings)
        : url_host_(settings.host.find(':') == std::string::npos ? settings.host : '[' + settings.host + ']'),
          scheme_(settings.tls.on() ? "https" : "http"),
          access_(settings.access, settings.tls.on()),
          signals_(network_, SIGTERM, SIGINT),
          hub_([this](const Wants& wants) { on_wants(wants); }),
          connections_(static_cast<std::size_t>(settings.max_connections), access_.knows_controllers()),
          place_{network_, encoding_, hub_, outgoing_},
          control_(settings.daemon),
          routes_(place_, access_, control_),
          listener_(settings, {place_, access_, routes_, connections_, guesses_}),
          frames_(settings.daemon, [this] { asio::post(network_, [this] { hub_.on_frame(frames_.take()); }); }),
          statuses_(
              settings.daemon,
              [this](DaemonState state) {
                  asio::post(network_, [this, state = std::move(state)] { hub_.on_state(state); });
              },
              [this](disparity::SensorBatch batch) {
                  asio::post(network_, [this, batch = std::move(batch)] { hub_.on_sensors(batch); });
              }) {}

    std::string url() const { return scheme_ + "://" + url_host_ + ':' + std::to_string(listener_.port()) + '/'; }

    void run() {
        signals_.async_wait([this](const boost::system::error_code& error, int) {
            if (!error) {
                listener_.stop();
                connections_.drop_all();
                network_.stop();
            }
        });
        listener_.start();
        network_.run();
        // Each may wait for a daemon that hangs: both at the same time.
        frames_.stop();
        statuses_.stop();
        // A second signal ends the program at once.
        signals_.clear();
        std::signal(SIGTERM, SIG_DFL);
        std::signal(SIGINT, SIG_DFL);
    }

private:
    void on_wants(const Wants& wants) {
        frames_.want(wants.products);
        statuses_.want_sensors(wants.sensors);
    }

    std::string url_host_;
    std::string scheme_;
    Access access_;
    Outgoing outgoing_;
    asio::io_context network_{1};
    asio::signal_set signals_;
    EncodingTurns encoding_;
    Hub hub_;
    Connections connections_;
    TokenGuesses guesses_;
    Workplace place_;
    DaemonControl control_;
    Routes routes_;
    PortListener listener_;
    FrameFeed frames_;
    StatusFeed statuses_;
};

Server::Server(const ServerSettings& settings) : impl_(std::make_unique<Impl>(settings)) {}
Server::~Server() = default;

std::string Server::url() const {
    return impl_->url();
}

void Server::run() {
    impl_->run();
}

}  // namespace disparityd::web
