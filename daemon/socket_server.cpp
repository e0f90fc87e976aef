// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket_server.h"

#include <algorithm>
#include <utility>

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include "capture/start_thread.h"
#include "daemon/log.h"

namespace disparityd {
namespace {

namespace asio = boost::asio;

/// Copies beyond those in the ring: one being filled, some on the way to the server's thread, one being compressed and
/// the one before it.
constexpr std::size_t copies_on_the_way = 5;

/// Connections beyond max_clients that are told so at the same time; further ones are closed without a word.
constexpr std::size_t max_refused = 16;

}  // namespace

SocketServer::SocketServer(const SocketServerConfig& config, SocketServices services)
    : work_(io_.get_executor()),
      services_(std::move(services)),
      config_(config),
      listeners_(make_listeners(config, {})),
      ring_(config.client_queue),
      compressor_(io_, compressing_.get_executor()),
      max_clients_(config.max_clients) {}

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

void SocketServer::start() {
    for (const auto& listener : listeners_) {
        listener->serve([this](ClientSession::Socket socket, std::string address) {
            accepted(std::move(socket), std::move(address));
        });
    }
    thread_ = capture::start_thread([this] { io_.run(); });
}

void SocketServer::stop() {
    if (!thread_.joinable()) {
        for (const auto& listener : listeners_) {
            listener->close();
        }
        listeners_.clear();
        return;
    }
    asio::post(io_, [this] {
        for (const auto& listener : listeners_) {
            listener->close();
        }
        for (auto* sessions : {&clients_, &refused_}) {
            for (const auto& [_, session] : *sessions) {
                session->stop();
            }
            sessions->clear();
        }
        wanted_.store(0, std::memory_order_relaxed);
        io_.stop();
    });
    thread_.join();
    listeners_.clear();
}

void SocketServer::reconfigure(const SocketServerConfig& config) {
    Listeners listeners = make_listeners(config, listeners_);
    for (const auto& listener : listeners) {
        if (std::find(listeners_.begin(), listeners_.end(), listener) == listeners_.end()) {
            listener->serve([this](ClientSession::Socket socket, std::string address) {
                accepted(std::move(socket), std::move(address));
            });
        }
    }
    Listeners ended;
    std::copy_if(listeners_.begin(), listeners_.end(), std::back_inserter(ended), [&](const auto& listener) {
        return std::find(listeners.begin(), listeners.end(), listener) == listeners.end();
    });
    listeners_ = std::move(listeners);
    config_ = config;
    asio::post(io_, [this, config, ended = std::move(ended)] {
        for (const auto& listener : ended) {
            listener->close();
        }
        max_clients_ = config.max_clients;
        ring_.set_capacity(config.client_queue);
    });
}

void SocketServer::set_layout(const StreamLayout& layout) {
    pool_ =
        listeners_.empty() ? nullptr : std::make_unique<FramePool>(layout, config_.client_queue + copies_on_the_way);
    asio::post(io_, [this, layout] {
        layout_ = layout;
        ring_.clear();
        for (const auto& session : sessions()) {
            session->layout_changed();
        }
    });
}

/// A copy of the table: a session that ends removes itself from it.
std::vector<std::shared_ptr<ClientSession>> SocketServer::sessions() const {
    std::vector<std::shared_ptr<ClientSession>> sessions;
    sessions.reserve(clients_.size());
    for (const auto& [_, client] : clients_) {
        sessions.push_back(client);
    }
    return sessions;
}

void SocketServer::publish(const PublishedFrame& frame) {
    const std::uint32_t wanted = wanted_.load(std::memory_order_acquire);
    if (wanted == 0 || !pool_) {
        return;
    }
    FrameHandle copy = pool_->copy(frame, wanted);
    if (!copy) {
        lost_.fetch_add(1, std::memory_order_relaxed);
        return;
    }
    asio::post(io_, [this, copy = std::move(copy)]() mutable { frame_arrived(std::move(copy)); });
}

void SocketServer::publish_sensors(std::span<const capture::SensorSample> samples, SensorRing::Time newest) {
    if (samples.empty() || !sensors_wanted_.load(std::memory_order_acquire)) {
        return;
    }
    if (samples_on_the_way_.load(std::memory_order_relaxed) + samples.size() > SensorRing::capacity) {
        samples_lost_ += static_cast<std::uint32_t>(samples.size());
        return;
    }
    samples_on_the_way_.fetch_add(samples.size(), std::memory_order_relaxed);
    std::vector<capture::SensorSample> copy(samples.begin(), samples.end());
    copy.front().lost_before += std::exchange(samples_lost_, 0);
    asio::post(io_, [this, copy = std::move(copy), newest] { sensors_arrived(copy, newest); });
}

std::vector<std::string> SocketServer::addresses() const {
    std::vector<std::string> addresses;
    for (const auto& listener : listeners_) {
        addresses.push_back(listener->address());
    }
    return addresses;
}

std::chrono::nanoseconds SocketServer::silence() {
    const auto now = std::chrono::steady_clock::now();
    if (answered_.exchange(false, std::memory_order_acq_rel)) {
        asked_ = now;
        asio::post(io_, [this] { answered_.store(true, std::memory_order_release); });
    }
    return now - asked_;
}

v1::Status SocketServer::status() {
    v1::Status status = services_.status();
    for (const auto& [_, client] : clients_) {
        if (client->greeted()) {
            *status.add_clients() = client->status();
        }
    }
    if (lost() > 0) {
        status.add_notices(fmt::format("{} frames were not offered to socket clients: the server was busy", lost()));
    }
    return status;
}

SessionHost::RecordAnswer SocketServer::in_server_thread(RecordAnswer answer) {
    return [this, answer = std::move(answer)](const v1::RecordStatus& status, const std::string& refusal) {
        asio::post(io_, [answer, status, refusal] { answer(status, refusal); });
    };
}

void SocketServer::start_recording(const std::string& path, RecordAnswer answer) {
    services_.start_recording(path, in_server_thread(std::move(answer)));
}

void SocketServer::stop_recording(RecordAnswer answer) {
    services_.stop_recording(in_server_thread(std::move(answer)));
}

void SocketServer::control_camera(const v1::CameraRequest& request, CameraAnswer answer) {
    services_.control_camera(
        request, [this, answer = std::move(answer)](const v1::CameraControls& controls, const std::string& refusal) {
            asio::post(io_, [answer, controls, refusal] { answer(controls, refusal); });
        });
}

void SocketServer::subscription_changed() {
    std::uint32_t wanted = 0;
    bool sensors = false;
    for (const auto& [_, client] : clients_) {
        wanted |= client->wanted();
        sensors = sensors || client->wants_sensors();
    }
    sensors_wanted_.store(sensors, std::memory_order_release);
    wanted_.store(wanted, std::memory_order_release);
}

void SocketServer::closed(std::uint64_t id) {
    clients_.erase(id);
    refused_.erase(id);
    subscription_changed();
}

void SocketServer::accepted(ClientSession::Socket socket, std::string address) {
    const std::uint64_t id = next_id_++;
    SessionHost& host = *this;
    if (clients_.size() < max_clients_) {
        const auto session = std::make_shared<ClientSession>(std::move(socket), std::move(address), id, host);
        clients_.emplace(id, session);
        session->start();
    } else if (refused_.size() < max_refused) {
        const auto session = std::make_shared<ClientSession>(std::move(socket), std::move(address), id, host);
        refused_.emplace(id, session);
        session->refuse(fmt::format("the daemon serves {} clients already, allowed: [socket] max_clients = {}",
                                    clients_.size(), max_clients_));
    } else {
        log_.broke_the_protocol.write(
            LogLevel::warning, fmt::format("{}: closed at once: too many clients that cannot be served", address));
    }
}

void SocketServer::frame_arrived(FrameHandle frame) {
    ring_.put(std::move(frame));
    for (const auto& session : sessions()) {
        session->frame_arrived();
    }
}

void SocketServer::sensors_arrived(const std::vector<capture::SensorSample>& samples, SensorRing::Time newest) {
    samples_on_the_way_.fetch_sub(samples.size(), std::memory_order_relaxed);
    sensors_.put(samples, newest);
    for (const auto& session : sessions()) {
        session->sensors_arrived();
    }
}

}  // namespace disparityd
