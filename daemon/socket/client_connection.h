// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <exception>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <boost/asio/steady_timer.hpp>

#include "daemon/socket/client_outbox.h"
#include "daemon/socket/client_stream.h"
#include "daemon/socket/rate_limit.h"
#include "proto/disparity.pb.h"

namespace disparityd::daemon {

class Clients;

/// The life of one connection: TLS first where there is some, messages in, messages out, and an end that its client can
/// read. What the messages mean is the business of the class that derives from it. Used by the server's thread only.
class ClientConnection : public std::enable_shared_from_this<ClientConnection> {
public:
    using Socket = ClientStream::Socket;

    virtual ~ClientConnection() = default;
    ClientConnection(const ClientConnection&) = delete;
    ClientConnection& operator=(const ClientConnection&) = delete;

    /// Waits for the client's Hello, with TLS after the handshake, which begins after `wait`.
    void start(std::chrono::nanoseconds wait = {});

    /// Sends the reason as an Error and closes; with TLS after the handshake.
    void refuse(const std::string& why, std::chrono::nanoseconds wait = {});

    /// Closes without an Error and releases the frames; for a server that stops.
    void stop() noexcept;

    /// Calls `action`. An exception closes this connection, with a line in the log, and affects no other client.
    template <typename Action>
    void guarded(Action action) noexcept {
        try {
            action();
        } catch (const std::exception& error) {
            failed(error);
        }
    }

protected:
    /// How far the connection has come. Every function that others call asks for it: until `hello` the handshake alone
    /// may touch the stream, whatever frames, samples, timers and reloads there are.
    enum class Phase {
        waiting,    ///< for its turn to shake hands
        handshake,  ///< of TLS
        hello,      ///< the first message must be Hello
        ready,      ///< messages go both ways
        deaf,       ///< the client no longer takes anything; what it had sent before is still done
        leaving,    ///< an Error with closing = true is the last message; nothing is read
        closed
    };

    ClientConnection(ClientStream stream, Clients& clients);

    bool is_open() const { return phase_ == Phase::hello || phase_ == Phase::ready; }
    bool may_read() const { return is_open() || phase_ == Phase::deaf; }
    /// Returns whether bytes may be written: an Error may still be on its way to a client that leaves.
    bool may_write() const { return is_open() || phase_ == Phase::leaving; }

    /// Hello has been said and accepted.
    void become_ready();

    /// Sends a message behind the others.
    void send(const v1::Envelope& message);
    void send_error(const std::string& why, bool closing);
    /// Writes what waits, until the socket takes no more.
    void pump();
    /// Reads the next message when it may be read.
    void read_length();
    /// The message that has arrived counts apart from requests: a client may send it with every frame.
    void limit_apart_from_requests();
    /// Calls action() later, unless the connection is closed or another deadline is set before.
    template <typename Action>
    void set_deadline(std::chrono::steady_clock::duration time, Action action);
    void close(std::string_view why) noexcept;

    /// Returns what a timer or the stream may call, guarded, with the connection, which it keeps alive until then.
    template <typename Function>
    auto handler(Function function) {
        return [self = shared_from_this(), function = std::move(function)](const auto&... arguments) mutable {
            self->guarded([&] { function(*self, arguments...); });
        };
    }
    ClientStream& stream() { return stream_; }
    const ClientStream& stream() const { return stream_; }
    ClientOutbox& outbox() { return outbox_; }
    const ClientOutbox& outbox() const { return outbox_; }
    Clients& clients() const { return clients_; }

private:
    // What the derived class does.
    /// TLS has been agreed on: the client's certificate is known.
    virtual void shook_hands() = 0;
    /// The client spoke something else than TLS and is about to be refused.
    virtual void speaks_no_tls() = 0;
    /// A message has arrived. Throws std::invalid_argument for one that closes the connection.
    virtual void arrived(const v1::Envelope& message) = 0;
    /// Returns whether nothing may be read, as the answer to a message is still to come.
    virtual bool awaits_answer() const = 0;
    /// Starts a message of samples or of a frame in the outbox. Returns false where there is none.
    virtual bool start_next() = 0;
    /// Nothing is called any more: timers end.
    virtual void stopped() noexcept = 0;
    /// The connection is closed and stopped.
    virtual void left(std::string_view why) noexcept = 0;
    /// Returns the client's name for a line of the log.
    virtual std::string label() const = 0;

    void failed(const std::exception& error) noexcept;
    template <typename Then>
    void shake_hands_after(std::chrono::nanoseconds wait, Then then);
    template <typename Then>
    void shake_hands(Then then);
    void handshake_failed(const boost::system::error_code& error);
    void await_length();
    void length_arrived(const boost::system::error_code& error);
    void read_message(std::uint32_t length);
    void message_arrived();
    void write_some();
    void await_writable();
    void close_later();
    void output_failed(const std::string& why);
    void end_output();
    void drain();

    ClientStream stream_;
    Clients& clients_;
    ClientOutbox outbox_;
    Phase phase_ = Phase::waiting;
    bool reading_ = false;
    bool output_ended_ = false;
    boost::asio::steady_timer deadline_;    ///< for the Hello, later for the client's end of a close
    boost::asio::steady_timer turn_timer_;  ///< until the handshake may begin
    boost::asio::steady_timer pace_timer_;  ///< until the next message may be read
    RateLimit requests_;
    RateLimit credits_;  ///< of Ready and Ping
    std::array<std::uint8_t, 4> length_{};
    std::vector<std::uint8_t> incoming_;
    std::array<std::uint8_t, 4096> discarded_{};  ///< input after the last message
};

template <typename Action>
void ClientConnection::set_deadline(std::chrono::steady_clock::duration time, Action action) {
    deadline_.expires_after(time);
    deadline_.async_wait(
        handler([action = std::move(action)](ClientConnection&, const boost::system::error_code& error) {
            if (!error) {
                action();
            }
        }));
}

}  // namespace disparityd::daemon
