// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/io_context.hpp>

#include "daemon/log.h"
#include "daemon/requests/request.h"
#include "daemon/socket/client_places.h"
#include "daemon/socket/client_rules.h"
#include "daemon/socket/client_session.h"
#include "daemon/socket/frames/frame_compressor.h"
#include "daemon/socket/frames/frame_ring.h"
#include "daemon/socket/frames/sensor_ring.h"
#include "daemon/socket/rate_limit.h"

namespace disparityd::daemon {

/// The clients of a server and what they share: the newest frames and samples, the rules, what may be asked for. Used
/// by the thread that runs the io_context, but for the functions of any thread.
class Clients {
public:
    /// `status` gives the daemon's, without the clients; it and the functions of `requests` are called in that thread.
    /// Frames are compressed in another, that of `compressing`.
    Clients(boost::asio::io_context& io, boost::asio::any_io_executor compressing, std::size_t queue,
            ClientPlaces places, ClientRules rules, Requests requests, std::function<v1::Status()> status,
            std::chrono::milliseconds handshake_interval);
    Clients(const Clients&) = delete;
    Clients& operator=(const Clients&) = delete;

    // What a session looks at.
    const StreamLayout& layout() const { return layout_; }
    FrameRing& frames() { return ring_; }
    FrameCompressor& compressor() { return compressor_; }
    const SensorRing& sensors() const { return sensors_; }
    ClientLog& log() { return log_; }
    const ClientRules& rules() const { return rules_; }
    /// Returns the request of this message; null where it is none.
    const Request* request(v1::Envelope::BodyCase message) const;
    /// Returns the names of all requests, "status_request, record_start".
    const std::string& names_of_requests() const { return names_of_requests_; }
    /// Returns whether something that this client has asked for goes on.
    bool something_goes_on_for(std::uint64_t client) const;
    /// Returns the daemon's status with its clients.
    v1::Status status();

    // What a session tells.
    void subscription_changed();
    /// Closes older connections of the client that `session` has greeted.
    void came_back(const ClientSession& session);
    void closed(std::uint64_t id) noexcept;
    /// A request was answered; its client may be gone since.
    void answered(std::uint64_t id) noexcept;

    // What the server tells.
    void accept(ClientSession::Socket socket, ClientPeer peer);
    void set_rules(ClientPlaces places, ClientRules rules, std::size_t queue);
    void set_layout(StreamLayout layout);
    void frame_arrived(FrameHandle frame);
    void sensors_arrived(const std::vector<capture::SensorSample>& samples, SensorRing::Time newest);
    /// Closes those that have been idle for too long; called at intervals.
    void watch() noexcept;
    /// Closes all; the thread has ended.
    void end_all() noexcept;

    // Of any thread.
    /// Returns the products that a client wants, as bits by number.
    std::uint32_t wanted() const { return wanted_.load(std::memory_order_acquire); }
    bool sensors_wanted() const { return sensors_wanted_.load(std::memory_order_acquire); }
    /// Returns how many clients have disconnected since the start.
    std::uint64_t gone() const { return gone_.load(std::memory_order_relaxed); }

private:
    template <typename Action>
    void for_each(Action action) noexcept;
    bool has_place(bool local) const;
    void make_place();
    void tell_gone(std::uint64_t client) noexcept;

    const Requests requests_;
    const std::string names_of_requests_;
    const std::function<v1::Status()> status_;
    StreamLayout layout_;
    FrameRing ring_;
    FrameCompressor compressor_;
    SensorRing sensors_;
    ClientLog log_;
    ClientPlaces places_;
    ClientRules rules_;
    RateLimit handshakes_;
    std::map<std::uint64_t, std::shared_ptr<ClientSession>> clients_;
    std::map<std::uint64_t, std::shared_ptr<ClientSession>> refused_;
    v1::Totals served_;  ///< of the clients that have gone
    std::uint64_t next_id_ = 1;

    // Between threads.
    std::atomic<std::uint32_t> wanted_{0};
    std::atomic<bool> sensors_wanted_{false};
    std::atomic<std::uint64_t> gone_{0};
};

}  // namespace disparityd::daemon
