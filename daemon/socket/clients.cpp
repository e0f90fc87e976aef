// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/clients.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "daemon/ends_alone.h"

namespace disparityd::daemon {
namespace {

/// A TLS handshake takes about a millisecond of the server's thread. So many may be done at once, for programs with
/// several connections. A client whose turn is later than this is closed: a flood of them must not keep frames from the
/// others.
constexpr int handshakes_at_once = 32;
constexpr std::chrono::seconds longest_wait_for_handshake{1};

std::string names_of(const Requests& requests) {
    std::string names;
    for (const Request& request : requests) {
        names += (names.empty() ? "" : ", ") + std::string(request.name);
    }
    return names;
}

}  // namespace

Clients::Clients(boost::asio::io_context& io, boost::asio::any_io_executor compressing, std::size_t queue,
                 ClientPlaces places, ClientRules rules, Requests requests, std::function<v1::Status()> status,
                 std::chrono::milliseconds handshake_interval)
    : requests_(std::move(requests)),
      names_of_requests_(names_of(requests_)),
      status_(std::move(status)),
      ring_(queue),
      compressor_(io, std::move(compressing)),
      places_(std::move(places)),
      rules_(std::move(rules)),
      handshakes_(handshakes_at_once, handshake_interval) {}

const Request* Clients::request(v1::Envelope::BodyCase message) const {
    const auto found = std::find_if(requests_.begin(), requests_.end(),
                                    [message](const Request& request) { return request.message == message; });
    return found == requests_.end() ? nullptr : &*found;
}

bool Clients::something_goes_on_for(std::uint64_t client) const {
    return std::any_of(requests_.begin(), requests_.end(),
                       [client](const Request& request) { return request.goes_on_for && request.goes_on_for(client); });
}

v1::Status Clients::status() {
    v1::Status status = status_();
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
    if (const std::string notice = places_.notice(); !notice.empty()) {
        status.add_notices(notice);
    }
    return status;
}

/// Calls `action` for each session. A session that ends removes only itself from the table.
template <typename Action>
void Clients::for_each(Action action) noexcept {
    for (auto client = clients_.begin(); client != clients_.end();) {
        const auto session = (client++)->second;
        session->guarded([&] { action(*session); });
    }
}

void Clients::subscription_changed() {
    std::uint32_t wanted = 0;
    bool sensors = false;
    for (const auto& [_, client] : clients_) {
        wanted |= client->wanted();
        sensors = sensors || client->wants_sensors();
    }
    sensors_wanted_.store(sensors, std::memory_order_release);
    wanted_.store(wanted, std::memory_order_release);
}

void Clients::came_back(const ClientSession& session) {
    for_each([&session](ClientSession& other) { other.make_room_for(session); });
}

void Clients::tell_gone(std::uint64_t client) noexcept {
    for (const Request& request : requests_) {
        if (request.client_is_gone) {
            ends_alone("what a client has asked for may go on without it", [&] { request.client_is_gone(client); });
        }
    }
}

void Clients::closed(std::uint64_t id) noexcept {
    if (const auto client = clients_.find(id); client != clients_.end()) {
        client->second->add_to(served_);
        clients_.erase(client);
        tell_gone(id);
    }
    refused_.erase(id);
    gone_.fetch_add(1, std::memory_order_relaxed);
    subscription_changed();
}

void Clients::answered(std::uint64_t id) noexcept {
    if (!clients_.contains(id)) {
        tell_gone(id);  // it left before what it had asked for began
    }
}

bool Clients::has_place(bool local) const {
    const auto by_tcp = static_cast<std::size_t>(
        std::count_if(clients_.begin(), clients_.end(), [](const auto& client) { return !client.second->local(); }));
    return places_.free_for(local, clients_.size(), by_tcp);
}

/// Closes the oldest connection over TCP that has not said hello: who shows nothing keeps out nobody.
void Clients::make_place() {
    for (const auto& [_, client] : clients_) {
        const auto session = client;  // it removes itself from the table
        if (!session->local() && session->make_place()) {
            return;
        }
    }
}

void Clients::accept(ClientSession::Socket socket, ClientPeer peer) {
    const std::uint64_t id = next_id_++;
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
        const auto session = std::make_shared<ClientSession>(to_stream(std::move(socket)), std::move(peer), id, *this);
        clients_.emplace(id, session);
        session->guarded([&] { session->start(wait); });
    } else if (refused_.size() < ClientPlaces::max_refused) {
        const auto session = std::make_shared<ClientSession>(to_stream(std::move(socket)), std::move(peer), id, *this);
        refused_.emplace(id, session);
        session->guarded([&] { session->refuse(places_.refusal(local), wait); });
    } else {
        log_.errors.write(LogLevel::warning,
                          fmt::format("{}: closed at once: too many clients wait for a refusal", peer.address));
    }
}

void Clients::set_rules(ClientPlaces places, ClientRules rules, std::size_t queue) {
    places_ = std::move(places);
    rules_ = std::move(rules);
    for_each([](ClientSession& session) { session.access_changed(); });
    ring_.set_capacity(queue);
}

void Clients::set_layout(StreamLayout layout) {
    layout_ = std::move(layout);
    ring_.clear();
    for_each([](ClientSession& session) { session.layout_changed(); });
}

void Clients::frame_arrived(FrameHandle frame) {
    ring_.put(std::move(frame));
    for_each([](ClientSession& session) { session.frame_arrived(); });
}

void Clients::sensors_arrived(const std::vector<capture::SensorSample>& samples, SensorRing::Time newest) {
    sensors_.put(samples, newest);
    for_each([](ClientSession& session) { session.sensors_arrived(); });
}

void Clients::watch() noexcept {
    for_each([](ClientSession& session) { session.watch(); });
}

void Clients::end_all() noexcept {
    for (auto* sessions : {&clients_, &refused_}) {
        for (const auto& [_, session] : *sessions) {
            session->stop();
        }
        sessions->clear();
    }
    wanted_.store(0, std::memory_order_relaxed);
}

}  // namespace disparityd::daemon
