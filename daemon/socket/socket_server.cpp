// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/socket_server.h"

#include <algorithm>
#include <new>
#include <utility>

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include "base/start_thread.h"
#include "base/words.h"
#include "daemon/log.h"

namespace disparityd::daemon {
namespace {

namespace asio = boost::asio;

/// Copies beyond those in the ring: one that is being filled, some on the way to the server's thread, the one that is
/// being compressed and the one before it.
constexpr std::size_t copies_on_the_way = 5;

/// A TLS handshake takes about a millisecond of the server's thread. So many may be done at once, for programs with
/// several connections. A client whose turn is later than this is closed: a flood of them must not keep frames from the
/// others.
constexpr int handshakes_at_once = 32;
constexpr std::chrono::seconds longest_wait_for_handshake{1};

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

SocketServer::SocketServer(const SocketServerConfig& config, SocketServices services)
    : work_(io_.get_executor()),
      services_(std::move(services)),
      config_(config),
      listeners_(make_listeners(config, {})),
      ring_(config.client_queue),
      compressor_(io_, compressing_.get_executor()),
      watch_timer_(io_),
      places_(places_of(config)),
      rules_(rules_of(config)),
      handshakes_(handshakes_at_once, config.handshake_interval) {}

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
        [this](ClientSession::Socket socket, ClientPeer peer) { accepted(std::move(socket), std::move(peer)); });
}

void SocketServer::start() {
    for (const auto& listener : listeners_) {
        serve(*listener);
    }
    serving_ = listeners_;
    asio::post(io_, [this] { watch_clients(); });
    thread_ = base::start_thread([this] { run(); });
}

/// Sessions and listeners handle their own exceptions. An exception that arrives here, of Asio or of a posted handler,
/// ends that handler only.
void SocketServer::run() noexcept {
    for (;;) {
        try {
            io_.run();
            return;
        } catch (...) {
            log_caught("the socket server continues after a failed handler");
        }
    }
}

/// Calls `action` for each session. A session that ends removes only itself from the table.
template <typename Action>
void SocketServer::for_each_session(Action action) noexcept {
    for (auto client = clients_.begin(); client != clients_.end();) {
        const auto session = (client++)->second;
        session->guarded([&] { action(*session); });
    }
}

/// Resumes what handlers could not do because memory was short.
void SocketServer::look_around() noexcept {
    for (const auto& listener : serving_) {
        listener->look();
    }
    compressor_.look();
    if (std::chrono::steady_clock::now() > watch_due_ + watch_interval(rules_)) {
        watch_clients();  // its timer was lost because memory was short
    }
    for_each_session([](ClientSession& session) { session.look_for_answer(); });
}

void SocketServer::end_all() noexcept {
    for (const auto& listener : serving_) {
        listener->close();
    }
    for (auto* sessions : {&clients_, &refused_}) {
        for (const auto& [_, session] : *sessions) {
            session->stop();
        }
        sessions->clear();
    }
    wanted_.store(0, std::memory_order_relaxed);
}

void SocketServer::stop() {
    if (!thread_.joinable()) {
        for (const auto& listener : listeners_) {
            listener->close();
        }
        listeners_.clear();
        return;
    }
    try {
        asio::post(io_, [this] { io_.stop(); });  // after what was posted before
    } catch (...) {
        io_.stop();
    }
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
                   places_ = places;
                   rules_ = rules_of(config);
                   for_each_session([](ClientSession& session) { session.access_changed(); });
                   ring_.set_capacity(config.client_queue);
               });
    listeners_ = std::move(listeners);
    config_ = std::move(kept);
}

void SocketServer::set_layout(const StreamLayout& layout) {
    pool_ =
        listeners_.empty() ? nullptr : std::make_unique<FramePool>(layout, config_.client_queue + copies_on_the_way);
    asio::post(io_, [this, layout]() mutable {
        layout_ = std::move(layout);
        ring_.clear();
        for_each_session([](ClientSession& session) { session.layout_changed(); });
    });
}

void SocketServer::publish(const PublishedFrame& frame) {
    const std::uint32_t wanted = wanted_.load(std::memory_order_acquire);
    if (wanted == 0 || !pool_) {
        return;
    }
    try {
        if (FrameHandle copy = pool_->copy(frame, wanted)) {
            asio::post(io_, [this, copy = std::move(copy)]() mutable { frame_arrived(std::move(copy)); });
            return;
        }
    } catch (const std::bad_alloc&) {
        log_caught("a frame is not offered to socket clients");
    }
    lost_.fetch_add(1, std::memory_order_relaxed);
}

void SocketServer::publish_sensors(std::span<const capture::SensorSample> samples, SensorRing::Time newest) {
    if (samples.empty() || !sensors_wanted_.load(std::memory_order_acquire)) {
        return;
    }
    if (samples_on_the_way_.load(std::memory_order_relaxed) + samples.size() > SensorRing::capacity) {
        samples_lost_ += static_cast<std::uint32_t>(samples.size());
        return;
    }
    try {
        std::vector<capture::SensorSample> copy(samples.begin(), samples.end());
        copy.front().lost_before += samples_lost_;
        asio::post(io_, [this, copy = std::move(copy), newest] { sensors_arrived(copy, newest); });
        samples_lost_ = 0;
        samples_on_the_way_.fetch_add(samples.size(), std::memory_order_relaxed);
    } catch (const std::bad_alloc&) {
        samples_lost_ += static_cast<std::uint32_t>(samples.size());
    }
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
        try {
            asio::post(io_, [this] {
                answered_.store(true, std::memory_order_release);
                look_around();
            });
        } catch (const std::bad_alloc&) {
            answered_.store(true, std::memory_order_release);  // the question was not posted
        }
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
    v1::Totals& totals = *status.mutable_totals();
    totals.set_clients(served_.clients());
    totals.set_client_frames_sent(served_.client_frames_sent());
    totals.set_client_frames_skipped(served_.client_frames_skipped());
    totals.set_client_bytes_sent(served_.client_bytes_sent());
    for (const auto& [_, client] : clients_) {
        client->add_to(totals);
    }
    if (lost() > 0) {
        status.add_notices(
            fmt::format("the socket server was too busy to offer clients {}", base::counted(lost(), "frame")));
    }
    if (const std::string notice = places_.notice(); !notice.empty()) {
        status.add_notices(notice);
    }
    return status;
}

SessionHost::RecordAnswer SocketServer::in_server_thread(RecordAnswer answer) {
    return [this, answer = std::move(answer)](const v1::RecordStatus& status, const std::string& refusal) {
        asio::post(io_, [answer, status, refusal] { answer(status, refusal); });
    };
}

void SocketServer::start_recording(const RecordRequest& request, RecordAnswer answer) {
    services_.start_recording(request,
                              in_server_thread([this, client = request.client, answer = std::move(answer)](
                                                   const v1::RecordStatus& status, const std::string& refusal) {
                                  answer(status, refusal);
                                  if (!clients_.contains(client)) {
                                      tell_gone(client);  // it left before its recording began
                                  }
                              }));
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

void SocketServer::trace(const v1::TraceRequest& request, TraceAnswer answer) {
    services_.trace(request, [this, answer = std::move(answer)](TraceParts parts, const std::string& refusal) {
        asio::post(io_, [answer, parts = std::move(parts), refusal] { answer(parts, refusal); });
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

void SocketServer::came_back(const ClientSession& session) {
    for_each_session([&session](ClientSession& other) { other.make_room_for(session); });
}

void SocketServer::tell_gone(std::uint64_t client) noexcept {
    try {
        if (services_.client_is_gone) {
            services_.client_is_gone(client);
        }
    } catch (...) {
        log_caught("a recording may go on without its client");
    }
}

void SocketServer::closed(std::uint64_t id) noexcept {
    if (const auto client = clients_.find(id); client != clients_.end()) {
        client->second->add_to(served_);
        clients_.erase(client);
        tell_gone(id);
    }
    refused_.erase(id);
    gone_.fetch_add(1, std::memory_order_relaxed);
    subscription_changed();
}

bool SocketServer::has_place(bool local) const {
    const auto by_tcp = static_cast<std::size_t>(
        std::count_if(clients_.begin(), clients_.end(), [](const auto& client) { return !client.second->local(); }));
    return places_.free_for(local, clients_.size(), by_tcp);
}

/// Closes the oldest connection over TCP that has not said hello: who shows nothing keeps out nobody.
void SocketServer::make_place() {
    for (const auto& [_, client] : clients_) {
        const auto session = client;  // it removes itself from the table
        if (!session->local() && session->make_place()) {
            return;
        }
    }
}

void SocketServer::accepted(ClientSession::Socket socket, ClientPeer peer) {
    const std::uint64_t id = next_id_++;
    SessionHost& host = *this;
    const bool local = peer.local;
    if (!local) {
        keep_alive(socket.native_handle(), rules_.liveness);
    }
    const bool encrypted = !local && rules_.tls;
    if (encrypted) {
        peer.address.replace(0, 3, "tls");
    }
    const RateLimit::Clock::duration wait = encrypted ? handshakes_.wait() : RateLimit::Clock::duration::zero();
    if (wait > longest_wait_for_handshake) {
        log_.errors.write(LogLevel::warning,
                          fmt::format("{}: closed at once: too many clients begin with TLS", peer.address));
        return;
    }
    if (encrypted) {
        handshakes_.take();
    }
    const auto to_stream = [&](ClientSession::Socket&& from) {
        return encrypted ? ClientStream(std::move(from), rules_.tls) : ClientStream(std::move(from));
    };
    if (!local && rules_.access.asks_over_tcp() && !has_place(local)) {
        make_place();
    }
    if (has_place(local)) {
        const auto session = std::make_shared<ClientSession>(to_stream(std::move(socket)), std::move(peer), id, host);
        clients_.emplace(id, session);
        session->guarded([&] { session->start(wait); });
    } else if (refused_.size() < ClientPlaces::max_refused) {
        const auto session = std::make_shared<ClientSession>(to_stream(std::move(socket)), std::move(peer), id, host);
        refused_.emplace(id, session);
        session->guarded([&] { session->refuse(places_.refusal(local), wait); });
    } else {
        log_.errors.write(LogLevel::warning,
                          fmt::format("{}: closed at once: too many clients wait for a refusal", peer.address));
    }
}

void SocketServer::watch_clients() noexcept {
    for_each_session([](ClientSession& session) { session.watch(); });
    watch_due_ = std::chrono::steady_clock::now() + watch_interval(rules_);
    try {
        watch_timer_.expires_at(watch_due_);
        watch_timer_.async_wait([this](const boost::system::error_code& error) {
            if (!error) {
                watch_clients();
            }
        });
    } catch (...) {
        log_caught("idle clients are looked for later");
    }
}

void SocketServer::frame_arrived(FrameHandle frame) {
    ring_.put(std::move(frame));
    for_each_session([](ClientSession& session) { session.frame_arrived(); });
}

void SocketServer::sensors_arrived(const std::vector<capture::SensorSample>& samples, SensorRing::Time newest) {
    samples_on_the_way_.fetch_sub(samples.size(), std::memory_order_relaxed);
    sensors_.put(samples, newest);
    for_each_session([](ClientSession& session) { session.sensors_arrived(); });
}

}  // namespace disparityd::daemon
