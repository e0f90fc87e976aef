// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/client_connection.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/read.hpp>
#include <fmt/format.h>

#include "base/failure_text.h"
#include "daemon/socket/clients.h"
#include "proto/framing.h"
#include "proto/text.h"

namespace disparityd::daemon {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

constexpr std::chrono::seconds hello_timeout{5};
constexpr std::chrono::seconds close_timeout{1};

}  // namespace

ClientConnection::ClientConnection(ClientStream stream, Clients& clients)
    : stream_(std::move(stream)),
      clients_(clients),
      deadline_(stream_.get_executor()),
      turn_timer_(stream_.get_executor()),
      pace_timer_(stream_.get_executor()),
      requests_(ClientRules::most_at_once, clients.rules().request_interval),
      credits_(ClientRules::most_at_once, ClientRules::credit_interval) {
    stream_.do_not_block();
}

// How a client comes in.

void ClientConnection::start(std::chrono::nanoseconds wait) {
    set_deadline(hello_timeout, [this] {
        if (phase_ == Phase::waiting || phase_ == Phase::handshake) {
            close(fmt::format("no TLS handshake within {} s", hello_timeout.count()));
        } else if (phase_ == Phase::hello) {
            send_error(fmt::format("no Hello within {} s: the first message must be Hello", hello_timeout.count()),
                       true);
        }
    });
    shake_hands_after(wait, [](ClientConnection& self) { self.read_length(); });
}

void ClientConnection::refuse(const std::string& why, std::chrono::nanoseconds wait) {
    set_deadline(hello_timeout, [this] { close("refused, and does not read why"); });
    shake_hands_after(wait, [why](ClientConnection& self) { self.send_error(why, true); });
}

/// Calls then(*this) after the TLS handshake, which begins after `wait`; at once without TLS.
template <typename Then>
void ClientConnection::shake_hands_after(std::chrono::nanoseconds wait, Then then) {
    if (!stream_.encrypted()) {
        phase_ = Phase::hello;
        then(*this);
        return;
    }
    if (wait.count() == 0) {
        shake_hands(std::move(then));
        return;
    }
    turn_timer_.expires_after(wait);
    turn_timer_.async_wait(handler([then = std::move(then)](ClientConnection& self, error_code error) mutable {
        if (!error && self.phase_ == Phase::waiting) {
            self.shake_hands(std::move(then));
        }
    }));
}

template <typename Then>
void ClientConnection::shake_hands(Then then) {
    phase_ = Phase::handshake;
    stream_.async_handshake(handler([then = std::move(then)](ClientConnection& self, error_code error) {
        if (self.phase_ != Phase::handshake) {
            return;  // it was closed meanwhile
        }
        if (error) {
            self.handshake_failed(error);
            return;
        }
        self.phase_ = Phase::hello;
        self.shook_hands();
        then(self);
    }));
}

void ClientConnection::handshake_failed(const error_code& error) {
    if (error == ClientStream::no_tls()) {
        speaks_no_tls();
        phase_ = Phase::hello;
        send_error(
            "this port speaks TLS only: connect to tls:HOST:PORT, with --authority FILE where the daemon's certificate "
            "is signed by an authority of your own",
            true);
        return;
    }
    clients_.log().errors.write(LogLevel::warning,
                                fmt::format("{}: closed: no TLS handshake: {}", label(), stream_.reason(error)));
    phase_ = Phase::leaving;
    close_later();
    end_output();  // after OpenSSL's alert, which tells the client why
}

void ClientConnection::become_ready() {
    phase_ = Phase::ready;
    deadline_.cancel();
}

// Messages in.

void ClientConnection::read_length() {
    if (!may_read() || reading_ || awaits_answer() || outbox_.is_full()) {
        return;
    }
    reading_ = true;
    const auto wait = std::max(requests_.wait(), credits_.wait());
    requests_.take();
    if (wait.count() == 0) {
        await_length();
        return;
    }
    pace_timer_.expires_after(wait);
    pace_timer_.async_wait(handler([](ClientConnection& self, error_code error) {
        if (!error && self.may_read()) {
            self.await_length();
        }
    }));
}

void ClientConnection::await_length() {
    asio::async_read(stream_, asio::buffer(length_), handler([](ClientConnection& self, error_code error, std::size_t) {
                         self.length_arrived(error);
                     }));
}

void ClientConnection::length_arrived(const error_code& error) {
    reading_ = false;
    if (!may_read()) {
        return;
    }
    if (error) {
        close(error == asio::error::eof ? "left" : "connection lost: " + stream_.reason(error));
        return;
    }
    std::uint32_t length = 0;
    try {
        length = proto::decode_length(length_, proto::max_client_envelope_bytes);
    } catch (const std::invalid_argument& refused) {
        send_error(refused.what(), true);
        return;
    }
    read_message(length);
}

void ClientConnection::read_message(std::uint32_t length) {
    reading_ = true;
    incoming_.clear();
    // The buffer grows with the bytes that arrive: a client may announce more than it sends.
    asio::async_read(stream_, asio::dynamic_buffer(incoming_, length), asio::transfer_exactly(length),
                     handler([](ClientConnection& self, error_code error, std::size_t) {
                         self.reading_ = false;
                         if (!self.may_read()) {
                             return;
                         }
                         if (error) {
                             self.close("left in the middle of a message: " + self.stream_.reason(error));
                             return;
                         }
                         self.message_arrived();
                     }));
}

void ClientConnection::message_arrived() {
    requests_.take(static_cast<std::int64_t>(incoming_.size() / ClientRules::bytes_of_one));
    v1::Envelope message;
    try {
        proto::decode(incoming_, message);
        incoming_.clear();
        incoming_.shrink_to_fit();
        if (message.payload_bytes() != 0) {
            send_error(fmt::format("a message announces a payload of {} bytes, allowed: 0", message.payload_bytes()),
                       true);
        } else if (phase_ == Phase::hello && !message.has_hello()) {
            send_error("the first message must be Hello", true);
        } else {
            arrived(message);
        }
    } catch (const std::invalid_argument& refused) {
        send_error(refused.what(), true);
    }
    read_length();
}

void ClientConnection::limit_apart_from_requests() {
    requests_.give_back();
    credits_.take();
}

// Messages out.

void ClientConnection::send(const v1::Envelope& message) {
    if (is_open()) {
        outbox_.add(message);
        pump();
    }
}

void ClientConnection::send_error(const std::string& why, bool closing) {
    if (phase_ == Phase::deaf && closing) {
        close("closed: " + why);
    }
    if (!is_open()) {
        return;
    }
    v1::Envelope message;
    message.mutable_error()->set_message(proto::to_valid_utf8(why));
    message.mutable_error()->set_closing(closing);
    outbox_.add(message);
    clients_.log().errors.write(LogLevel::warning,
                                fmt::format("{}: {}: {}", label(), closing ? "closed" : "refused", why));
    if (closing) {
        phase_ = Phase::leaving;
        clients_.subscription_changed();
        close_later();
    }
    pump();
}

void ClientConnection::pump() {
    while (may_write() && !outbox_.writing()) {
        if (!outbox_.start_answer()) {
            if (phase_ == Phase::leaving) {
                end_output();
                return;
            }
            if (!start_next()) {
                break;
            }
        }
        write_some();
    }
    read_length();  // there may be room for answers again
}

/// Writes as much as the socket takes at once. Asio holds no address of the message between two writes, so the planes
/// may move (Payload::keep_copy()).
void ClientConnection::write_some() {
    error_code error;
    const bool all_sent = outbox_.sent(stream_.write_some(outbox_.rest(), error));
    if (error && error != asio::error::would_block && error != asio::error::interrupted) {
        output_failed("connection lost: " + stream_.reason(error));
    } else if (!all_sent) {
        await_writable();
    }
}

void ClientConnection::await_writable() {
    stream_.async_wait_writable(handler([](ClientConnection& self, error_code error) {
        if (!self.may_write()) {
            return;
        }
        if (error) {
            self.output_failed("connection lost: " + error.message());
            return;
        }
        self.write_some();
        self.pump();
    }));
}

// How a connection ends.

/// A client that has gone may have asked for something in its last moment, such as the end of a recording: what lies in
/// the socket is read and done before the connection is closed.
void ClientConnection::output_failed(const std::string& why) {
    if (phase_ != Phase::ready) {
        close(why);
        return;
    }
    phase_ = Phase::deaf;
    outbox_.clear();
    clients_.subscription_changed();
    // Reading finds the end of what the client has sent. One that keeps its connection half open, or asked for what
    // takes long, gets no more than this time.
    set_deadline(close_timeout, [this] {
        if (phase_ == Phase::deaf) {
            close("left");
        }
    });
    read_length();
}

/// Ends the connection even if its last message cannot be written.
void ClientConnection::close_later() {
    set_deadline(close_timeout, [this] { close("closed after an error"); });
}

/// Tells the client, once, that nothing follows its last message, and lets it read that one.
void ClientConnection::end_output() {
    if (std::exchange(output_ended_, true)) {
        return;
    }
    stream_.end_output();
    drain();
}

/// Reads until the client closes: the system throws the last message away if input is unread at a close.
void ClientConnection::drain() {
    stream_.async_discard(asio::buffer(discarded_), handler([](ClientConnection& self, error_code error, std::size_t) {
                              if (self.phase_ == Phase::closed) {
                                  return;
                              }
                              if (error) {
                                  self.close("closed after an error");
                              } else {
                                  self.drain();
                              }
                          }));
}

void ClientConnection::failed(const std::exception& error) noexcept {
    close("closed: " + base::failure_text(error));
}

void ClientConnection::stop() noexcept {
    phase_ = Phase::closed;
    error_code ignored;
    stream_.close();
    deadline_.cancel(ignored);
    turn_timer_.cancel(ignored);
    pace_timer_.cancel(ignored);
    // An answer that is still to come keeps this object alive. It must not keep frames.
    outbox_.release_frames();
    stopped();
}

void ClientConnection::close(std::string_view why) noexcept {
    if (phase_ != Phase::closed) {
        stop();
        left(why);
    }
}

}  // namespace disparityd::daemon
