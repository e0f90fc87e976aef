// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "daemon/published_frame.h"
#include "daemon/requests/request.h"
#include "daemon/socket/client_handler.h"
#include "daemon/socket/client_peer.h"
#include "daemon/socket/client_rules.h"
#include "daemon/socket/client_stream.h"
#include "daemon/socket/client_subscription.h"
#include "daemon/socket/frames/frame_compressor.h"
#include "daemon/socket/frames/outgoing_message.h"
#include "daemon/socket/rate_limit.h"

namespace disparityd::daemon {

class Clients;

/// One connection: reads requests, writes answers and frames, and closes when a rule is broken. Its memory is bounded:
/// one incoming message (1 MiB at most), a few answers or a trace (12 MiB at most), one outgoing frame and one
/// compressed frame behind it. Frames that wait belong to the server (FrameRing). A client that does not read stays
/// connected; frames are skipped for it. Used by the server's thread only.
class ClientSession : public std::enable_shared_from_this<ClientSession>, public FrameCompressor::Client {
public:
    using Socket = ClientStream::Socket;

    ClientSession(ClientStream stream, ClientPeer peer, std::uint64_t id, Clients& clients);

    /// Waits for the client's Hello, with TLS after the handshake, which begins after `wait`.
    void start(std::chrono::nanoseconds wait = {});

    /// Sends the reason as an Error and closes; with TLS after the handshake.
    void refuse(const std::string& why, std::chrono::nanoseconds wait = {});

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

    /// Closes without an Error and releases the frames; for a server that stops.
    void stop() noexcept;

    /// Calls `action`. An exception closes this connection, with a line in the log, and affects no other client.
    template <typename Action>
    void guarded(Action action) noexcept {
        try {
            action();
        } catch (...) {
            failed();
        }
    }

    /// Closes because Asio has destroyed a handler uncalled; see ClientHandler.
    void handler_lost() noexcept { close("closed: there was no memory to go on with it"); }

    /// Closes the connection if the answer that it waits for can no longer come. The server calls this at intervals.
    void look_for_answer() noexcept;

    bool greeted() const { return greeted_; }
    bool local() const { return peer_.local; }
    std::uint32_t wanted() const { return is_open() ? subscription_.products() : 0; }
    bool wants_sensors() const { return is_open() && subscription_.sensors(); }
    v1::ClientStatus status();

    /// Adds what this client was sent, and the client itself once it has said hello.
    void add_to(v1::Totals& totals) const noexcept;

private:
    /// How far the connection has come. Every function that others call asks for it: until `open` the handshake alone
    /// may touch the stream, whatever frames, samples, timers and reloads there are.
    enum class Phase {
        waiting,    ///< for its turn to shake hands
        handshake,  ///< of TLS
        open,       ///< messages go both ways, Hello first
        deaf,       ///< the client no longer takes anything; what it had sent before is still done
        leaving,    ///< an Error with closing = true is the last message; nothing is read
        closed
    };
    bool is_open() const { return phase_ == Phase::open; }
    bool may_read() const { return phase_ == Phase::open || phase_ == Phase::deaf; }
    /// Returns whether bytes may be written: an Error may still be on its way to a client that leaves.
    bool may_write() const { return phase_ == Phase::open || phase_ == Phase::leaving; }

    template <typename Function>
    auto handler(Function function) {
        return ClientHandler<ClientSession, Function>(shared_from_this(), std::move(function));
    }
    std::shared_ptr<void> ask();
    void failed() noexcept;
    template <typename Then>
    void shake_hands_after(std::chrono::nanoseconds wait, Then then);
    template <typename Then>
    void shake_hands(Then then);
    void handshake_failed(const boost::system::error_code& error);
    void read_length();
    void await_length();
    bool waits_for_something() const;
    void length_arrived(const boost::system::error_code& error);
    void read_message(std::uint32_t length);
    void message_arrived();
    void handle(const v1::Envelope& message);
    void hello(const v1::Hello& hello);
    std::string why_refused(const std::string& token) const;
    bool admit(const std::string& token);
    void refuse_late(const std::string& why);
    void subscribe(const v1::Subscribe& wanted);
    void add_credit(const v1::Ready& ready);
    void answer_ping(const v1::Ping& ping);
    void limit_apart_from_requests();
    bool holds_back();
    void send_status_every(double seconds);
    bool may_control(std::string_view what);
    void pass_on(const Request& request, const v1::Envelope& message);
    Reply reply();
    void answer(Answer answer);
    void send(v1::Envelope message);
    void send_error(const std::string& why, bool closing);
    void pump();
    bool take_sensors();
    bool take_frame();
    bool take_compressed();
    bool may_compress() const;
    void ask_for_compressed();
    FrameCompressor::Request take_request();
    FrameCompressor::Request next_request() noexcept override;
    bool same_request(const FrameCompressor::Request& request) const noexcept override;
    void compressed(const FrameCompressor::Request& request,
                    std::shared_ptr<const EncodedPlanes> planes) noexcept override;
    void not_compressed(const std::string& why) noexcept override;
    v1::Envelope make_head(const FrameCompressor::Request& request, const EncodedPlanes& planes);
    void write();
    void write_some();
    void await_writable();
    void close_later();
    void output_failed(const std::string& why);
    void end_output();
    void drain();
    void close(std::string_view why) noexcept;
    std::string label() const;

    ClientStream stream_;
    ClientPeer peer_;
    const std::uint64_t id_;
    Clients& clients_;
    boost::asio::steady_timer deadline_;  ///< for the Hello, later for the client's end of a close
    boost::asio::steady_timer status_timer_;
    boost::asio::steady_timer turn_timer_;  ///< until the handshake may begin
    boost::asio::steady_timer pace_timer_;  ///< until the next message may be read
    RateLimit requests_;
    RateLimit credits_;  ///< of Ready and Ping
    std::chrono::steady_clock::time_point last_request_;

    std::string name_;
    std::string token_;            ///< of its Hello
    std::uint64_t client_id_ = 0;  ///< of its Hello; 0 = none
    Phase phase_ = Phase::waiting;
    bool greeted_ = false;  ///< has said hello, and may have left since
    bool output_ended_ = false;

    std::array<std::uint8_t, 4> length_{};
    std::vector<std::uint8_t> incoming_;
    std::array<std::uint8_t, 4096> discarded_{};  ///< input after the last message
    bool reading_ = false;
    bool answer_pending_ = false;   ///< no request is read before the answer
    std::weak_ptr<void> question_;  ///< expires when nobody can answer any more

    std::deque<std::vector<std::uint8_t>> answers_;
    OutgoingMessage message_;       ///< being written
    v1::Envelope compressed_head_;  ///< of compressed_, the next message
    std::chrono::steady_clock::time_point compressed_captured_;
    std::shared_ptr<const EncodedPlanes> compressed_;
    bool compressing_ = false;  ///< waits for its turn, or its frame is being compressed
    bool outdated_ = false;     ///< another subscription replaces what is being compressed
    bool writing_ = false;      ///< message_ is not written in full yet
    bool stall_logged_ = false;
    std::chrono::steady_clock::time_point write_started_;

    ClientSubscription subscription_;
    std::size_t frame_bytes_ = 0;  ///< of the frame's message sent last
    bool wants_status_ = false;    ///< at intervals
    bool has_subscribed_ = false;
    std::uint64_t bytes_sent_ = 0;
};

}  // namespace disparityd::daemon
