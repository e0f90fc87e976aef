// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include <boost/asio/steady_timer.hpp>

#include "daemon/requests/request.h"
#include "daemon/socket/client_connection.h"
#include "daemon/socket/client_peer.h"
#include "daemon/socket/client_rules.h"
#include "daemon/socket/client_subscription.h"
#include "daemon/socket/frames/frame_compressor.h"

namespace disparityd::daemon {

/// What a client says and is told: Hello, requests, its subscription, frames and samples. Its memory is bounded: one
/// incoming message (1 MiB at most), a few answers or a trace (12 MiB at most), one outgoing frame and one compressed
/// frame behind it. Frames that wait belong to the server (FrameRing). A client that does not read stays connected;
/// frames are skipped for it. Used by the server's thread only.
class ClientSession final : public ClientConnection, public FrameCompressor::Client {
public:
    ClientSession(ClientStream stream, ClientPeer peer, std::uint64_t id, Clients& clients);

    /// The server calls this when the ring has a new frame.
    void frame_arrived();

    /// The server calls this when the ring has new samples.
    void sensors_arrived();

    /// The server calls this when frames get another layout. Subscribed products may no longer exist.
    void layout_changed();

    /// Closes the connection if the client has been idle for too long or its machine no longer answers. The server
    /// calls this at intervals.
    void watch();

    /// Closes the connection if its client may no longer look. The server calls this after a reload.
    void access_changed();

    /// Closes the connection of a client that has not said hello, for another one. Returns false after hello.
    bool make_place() noexcept;

    /// Closes this connection if `newer` is another one of the same client: its link was cut, and it has connected
    /// anew. Only one of the same rights may end it.
    void make_room_for(const ClientSession& newer) noexcept;

    bool greeted() const { return greeted_; }
    bool local() const { return peer_.local; }
    std::uint32_t wanted() const { return is_open() ? subscription_.products() : 0; }
    bool wants_sensors() const { return is_open() && subscription_.sensors(); }
    v1::ClientStatus status();

    /// Adds what this client was sent, and the client itself once it has said hello.
    void add_to(v1::Totals& totals) const noexcept;

private:
    std::shared_ptr<ClientSession> self() { return std::static_pointer_cast<ClientSession>(shared_from_this()); }

    // Of the connection.
    void shook_hands() override;
    void speaks_no_tls() override;
    void arrived(const v1::Envelope& message) override;
    bool awaits_answer() const override { return answer_pending_; }
    bool start_next() override;
    void stopped() noexcept override;
    void left(std::string_view why) noexcept override;
    std::string label() const override;

    // Of the compressor.
    FrameCompressor::Request next_request() noexcept override;
    bool same_request(const FrameCompressor::Request& request) const noexcept override;
    void compressed(const FrameCompressor::Request& request,
                    std::shared_ptr<const EncodedPlanes> planes) noexcept override;
    void not_compressed(const std::string& why) noexcept override;

    bool waits_for_something() const;
    void hello(const v1::Hello& hello);
    std::string why_refused(const std::string& token) const;
    bool admit(const std::string& token);
    void refuse_late(const std::string& why);
    bool may_control(std::string_view what);
    void subscribe(const v1::Subscribe& wanted);
    void send_status_every(double seconds);
    void add_credit(const v1::Ready& ready);
    void answer_ping(const v1::Ping& ping);
    void pass_on(const Request& request, const v1::Envelope& message);
    Reply reply(std::shared_ptr<RateLimit> rate);
    void answer(const Answer& answer);
    bool take_sensors();
    bool take_frame();
    bool take_compressed();
    bool may_compress() const;
    void ask_for_compressed();
    FrameCompressor::Request take_request();
    v1::Envelope make_head(const FrameCompressor::Request& request, const EncodedPlanes& planes);
    bool holds_back();

    ClientPeer peer_;
    const std::uint64_t id_;
    std::string name_;
    std::string token_;            ///< of its Hello
    std::uint64_t client_id_ = 0;  ///< of its Hello; 0 = none
    bool greeted_ = false;         ///< has said hello, and may have left since
    std::chrono::steady_clock::time_point last_request_;
    bool answer_pending_ = false;  ///< no request is read before the answer
    ClientSubscription subscription_;
    bool has_subscribed_ = false;
    bool compressing_ = false;   ///< waits for its turn, or its frame is being compressed
    bool outdated_ = false;      ///< another subscription replaces what is being compressed
    bool wants_status_ = false;  ///< at intervals
    boost::asio::steady_timer status_timer_;
};

}  // namespace disparityd::daemon
