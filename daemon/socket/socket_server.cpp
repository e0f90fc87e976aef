// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/socket_server.h"

#include <algorithm>
#include <utility>

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include "base/start_thread.h"
#include "base/words.h"
#include "daemon/ends_alone.h"
#include "daemon/log.h"
#include "daemon/requests/status_request.h"

namespace disparityd::daemon {
namespace {

namespace asio = boost::asio;

ClientRules rules_of(const SocketServerConfig& config) {
    ClientRules rules{config.access, config.tls, config.idle_timeout, config.liveness, config.request_interval};
    rules.access.unix_path = config.unix_path;
    rules.access.encrypted = config.tls != nullptr;
    return rules;
}

/// Makes the limit of clients; logs a line if it is lower than configured.
ClientPlaces places_of(const SocketServerConfig& config) {
    const ClientPlaces places(config.max_clients, config.descriptors, !config.tcp.empty(), !config.unix_path.empty());
    if (!places.notice().empty()) {
        log_warning(places.notice());
    }
    return places;
}

/// Returns the interval of watch(): no client stays much longer than its time limit.
std::chrono::milliseconds watch_interval(const ClientRules& rules) {
    using std::chrono::milliseconds;
    milliseconds shortest = rules.liveness.longest_silence();
    if (rules.idle_timeout.count() > 0) {
        shortest = std::min(shortest, rules.idle_timeout);
    }
    return std::clamp(shortest / 4, milliseconds(20), milliseconds(1000));
}

}  // namespace

SocketServer::SocketServer(const SocketServerConfig& config, std::function<v1::Status()> status, Requests requests)
    : work_(io_.get_executor()),
      status_(std::move(status)),
      config_(config),
      listeners_(make_listeners(config, {})),
      watch_timer_(io_),
      watch_interval_(watch_interval(rules_of(config))),
      clients_(
          io_, compressing_.get_executor(), config.client_queue, places_of(config), rules_of(config),
          with_status(std::move(requests)), [this] { return status_and_losses(); }, config.handshake_interval) {}

/// Adds the request that the server answers itself: it knows the clients.
Requests SocketServer::with_status(Requests requests) {
    requests.insert(requests.begin(), status_request([this] { return clients_.status(); }));
    return requests;
}

/// Returns the daemon's status, and what clients did not get because of the server.
v1::Status SocketServer::status_and_losses() const {
    v1::Status status = status_();
    if (lost() > 0) {
        status.add_notices(
            fmt::format("the socket server was too busy to offer clients {}", base::counted(lost(), "frame")));
    }
    return status;
}

SocketServer::~SocketServer() {
    stop();
}

SocketServer::Listeners SocketServer::make_listeners(const SocketServerConfig& config, const Listeners& kept) {
    Listeners listeners;
    const auto keep = [&](const std::string& prefix) {
        const auto same = std::find_if(kept.begin(), kept.end(),
                                       [&](const auto& listener) { return listener->address().starts_with(prefix); });
        listeners.push_back(*same);
    };
    if (!config.tcp.empty()) {
        if (!kept.empty() && config.tcp == config_.tcp) {
            keep("tcp:");
        } else {
            listeners.push_back(make_tcp_listener(io_, config.tcp));
        }
    }
    if (!config.unix_path.empty()) {
        if (!kept.empty() && config.unix_path == config_.unix_path) {
            keep("unix:");
        } else {
            listeners.push_back(make_unix_listener(io_, config.unix_path));
        }
    }
    return listeners;
}

void SocketServer::serve(Listener& listener) {
    listener.serve(
        [this](ClientSession::Socket socket, ClientPeer peer) { clients_.accept(std::move(socket), std::move(peer)); });
}

void SocketServer::start() {
    for (const auto& listener : listeners_) {
        serve(*listener);
    }
    serving_ = listeners_;
    asio::post(io_, [this] { watch_clients(); });
    thread_ = base::start_thread([this] { run(); });
}

/// Sessions and listeners handle their own exceptions. One that arrives here ends its handler only.
void SocketServer::run() {
    while (!ends_alone("the socket server continues after a failed handler", [this] { io_.run(); })) {
    }
}

void SocketServer::end_all() noexcept {
    for (const auto& listener : serving_) {
        listener->close();
    }
    clients_.end_all();
}

void SocketServer::stop() {
    if (!thread_.joinable()) {
        for (const auto& listener : listeners_) {
            listener->close();
        }
        listeners_.clear();
        return;
    }
    asio::post(io_, [this] { io_.stop(); });  // after what was posted before
    thread_.join();
    end_all();
    serving_.clear();
    listeners_.clear();
}

void SocketServer::reconfigure(const SocketServerConfig& config) {
    Listeners listeners = make_listeners(config, listeners_);
    for (const auto& listener : listeners) {
        if (std::find(listeners_.begin(), listeners_.end(), listener) == listeners_.end()) {
            serve(*listener);
        }
    }
    Listeners ended;
    std::copy_if(listeners_.begin(), listeners_.end(), std::back_inserter(ended), [&](const auto& listener) {
        return std::find(listeners.begin(), listeners.end(), listener) == listeners.end();
    });
    SocketServerConfig kept = config;
    asio::post(io_,
               [this, config, places = places_of(config), serving = listeners, ended = std::move(ended)]() mutable {
                   serving_ = std::move(serving);
                   for (const auto& listener : ended) {
                       listener->close();
                   }
                   const ClientRules rules = rules_of(config);
                   watch_interval_ = watch_interval(rules);
                   clients_.set_rules(places, rules, config.client_queue);
               });
    listeners_ = std::move(listeners);
    config_ = std::move(kept);
}

void SocketServer::set_layout(const StreamLayout& layout) {
    pool_ =
        listeners_.empty() ? nullptr : std::make_unique<FramePool>(layout, config_.client_queue + copies_on_the_way);
    asio::post(io_, [this, layout]() mutable { clients_.set_layout(std::move(layout)); });
}

void SocketServer::publish(const PublishedFrame& frame) {
    const std::uint32_t wanted = clients_.wanted();
    if (wanted == 0 || !pool_) {
        return;
    }
    if (FrameHandle copy = pool_->copy(frame, wanted)) {
        asio::post(io_, [this, copy = std::move(copy)]() mutable { clients_.frame_arrived(std::move(copy)); });
    } else {
        lost_.fetch_add(1, std::memory_order_relaxed);
    }
}

void SocketServer::publish_sensors(std::span<const capture::SensorSample> samples, SensorRing::Time newest) {
    if (samples.empty() || !clients_.sensors_wanted()) {
        return;
    }
    if (samples_on_the_way_.load(std::memory_order_relaxed) + samples.size() > SensorRing::capacity) {
        samples_lost_ += static_cast<std::uint32_t>(samples.size());
        return;
    }
    std::vector<capture::SensorSample> copy(samples.begin(), samples.end());
    copy.front().lost_before += std::exchange(samples_lost_, 0);
    samples_on_the_way_.fetch_add(samples.size(), std::memory_order_relaxed);
    asio::post(io_, [this, copy = std::move(copy), newest] {
        samples_on_the_way_.fetch_sub(copy.size(), std::memory_order_relaxed);
        clients_.sensors_arrived(copy, newest);
    });
}

std::vector<std::string> SocketServer::addresses() const {
    std::vector<std::string> addresses;
    for (const auto& listener : listeners_) {
        const std::string address = listener->address();
        addresses.push_back(config_.tls && address.starts_with("tcp:") ? "tls:" + address.substr(4) : address);
    }
    return addresses;
}

std::string SocketServer::lost_address() const {
    const auto lost =
        std::find_if(listeners_.begin(), listeners_.end(), [](const auto& listener) { return !listener->in_place(); });
    return lost == listeners_.end() ? "" : (*lost)->address();
}

void SocketServer::restore() {
    Listeners listeners = listeners_;
    Listeners lost;
    for (auto& listener : listeners) {
        if (!listener->in_place()) {
            lost.push_back(std::exchange(listener, make_unix_listener(io_, config_.unix_path)));
            serve(*listener);
        }
    }
    asio::post(io_, [this, serving = listeners, lost = std::move(lost)]() mutable {
        serving_ = std::move(serving);
        for (const auto& listener : lost) {
            listener->close();
        }
    });
    listeners_ = std::move(listeners);
}

std::chrono::nanoseconds SocketServer::silence() {
    const auto now = std::chrono::steady_clock::now();
    if (answered_.exchange(false, std::memory_order_acq_rel)) {
        asked_ = now;
        asio::post(io_, [this] { answered_.store(true, std::memory_order_release); });
    }
    return now - asked_;
}

void SocketServer::watch_clients() {
    clients_.watch();
    watch_timer_.expires_after(watch_interval_);
    watch_timer_.async_wait([this](const boost::system::error_code& error) {
        if (!error) {
            watch_clients();
        }
    });
}

}  // namespace disparityd::daemon
