// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "clients/cpp/daemon_clock.h"
#include "clients/cpp/liveness.h"
#include "clients/cpp/message_stream.h"

namespace disparity {

/// Carries the message of a daemon that refuses.
class Refused : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// The connection of a client, and the one after it: says Hello and the subscription again, knows the daemon's clock,
/// and notices when the daemon no longer answers. What it throws has one line that names the address.
class Connection {
public:
    using Outcome = MessageStream::Outcome;

    /// Connects and says Hello. Throws as SocketClient.
    Connection(const std::string& address, ConnectOptions options, const std::string& name,
               std::chrono::milliseconds timeout);

    /// Returns whether the connection has ended; come_back() makes another one.
    bool lost() const { return lost_; }

    /// Connects again, says Hello and subscribes as before. Returns false when no daemon has answered by the deadline;
    /// the next call continues. Throws when the daemon refuses until then.
    bool come_back(Deadline deadline);

    /// Waits for the next message, other than those about the clock. `closed`: why_gone() says why. Throws Refused for
    /// an Error of the daemon, std::runtime_error for what is no message.
    Outcome receive(Deadline deadline);

    /// As receive(), and asks a daemon that says nothing whether it is still there: after half a second, or three of
    /// the intervals of what is expected. Without an answer the connection has ended.
    Outcome listen(Deadline deadline, std::int64_t interval_ns);

    /// Asks for the daemon's clock when the last question is a second old; listen() does, too. Also of a connection
    /// that has ended, which is not asked.
    void keep_clock();

    /// Returns the message of the last receive() or listen() that was `done`; valid until the next one.
    const disparityd::v1::Envelope& envelope() const { return stream_->envelope(); }
    const std::vector<std::uint8_t>& payload() const { return stream_->payload(); }

    /// Sends a request. Throws when the connection has ended, with the daemon's last words if there were any.
    void send(const disparityd::v1::Envelope& envelope, Deadline deadline);

    /// Sends the subscription, to every connection from now on.
    void subscribe(const disparityd::v1::Envelope& subscription);

    /// Lets the daemon send so many frames more. Only for a daemon that works by_credit().
    void give_credit(std::uint32_t frames);

    /// Ends the connection.
    void end(const std::string& why);

    /// Returns whether the daemon sends frames against credit, and answers questions about its clock.
    bool by_credit() const { return by_credit_; }
    const DaemonClock& clock() const { return clock_; }

    /// Returns when a look at the socket found nothing, CLOCK_MONOTONIC; 0 = not yet.
    std::int64_t empty_ns() const { return stream_ ? stream_->empty_ns() : 0; }

    const std::string& address() const { return address_; }
    const std::string& welcome() const { return welcome_; }
    const std::string& why_gone() const { return why_gone_; }
    /// Returns whether the connection has ended for want of an answer, and none was made since.
    bool unanswered() const { return unanswered_; }
    std::optional<unsigned> server_user() const { return stream_ ? stream_->server_user() : std::nullopt; }

    /// Throws an exception whose line begins with the address.
    template <class Exception = std::runtime_error>
    [[noreturn]] void fail(const std::string& what) const {
        throw Exception("disparityd at " + address_ + ": " + what);
    }

private:
    void connect(Deadline deadline, Deadline greeting);
    bool greeted(Deadline deadline);
    std::string token() const;
    void send_subscription();
    void ask(std::int64_t now_ns, std::int64_t interval_ns);
    void take_pong();
    bool answers(std::int64_t interval_ns);

    std::string address_;
    ConnectOptions options_;
    std::string name_;
    std::uint64_t client_id_;
    std::unique_ptr<MessageStream> stream_;  ///< none between two connections
    bool lost_ = false;                      ///< the connection has ended; a new stream_ has no answer to Hello yet
    Deadline greeting_;
    std::int64_t hello_ns_ = 0;
    std::optional<disparityd::v1::Envelope> subscription_;
    std::string why_gone_;
    std::string ended_by_;  ///< ": why", where TLS has told it
    std::string welcome_;
    bool by_credit_ = false;
    bool unanswered_ = false;
    DaemonClock clock_;
    Liveness liveness_;
};

}  // namespace disparity
