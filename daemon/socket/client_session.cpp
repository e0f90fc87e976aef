// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/client_session.h"

#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/dispatch.hpp>
#include <boost/asio/read.hpp>
#include <fmt/format.h>

#include "base/failure_text.h"
#include "base/message_text.h"
#include "daemon/socket/clients.h"
#include "proto/framing.h"
#include "proto/monotonic_clock.h"

namespace disparityd::daemon {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

/// Answers that may wait for a client before nothing more is read from it.
constexpr std::size_t max_answers = 8;
constexpr std::size_t max_name = 64;  ///< bytes shown
}  // namespace

ClientSession::ClientSession(ClientStream stream, ClientPeer peer, std::uint64_t id, Clients& clients)
    : stream_(std::move(stream)),
      peer_(std::move(peer)),
      id_(id),
      clients_(clients),
      deadline_(stream_.get_executor()),
      status_timer_(stream_.get_executor()),
      turn_timer_(stream_.get_executor()),
      pace_timer_(stream_.get_executor()),
      requests_(ClientRules::most_at_once, clients.rules().request_interval),
      credits_(ClientRules::most_at_once, ClientRules::credit_interval) {
    stream_.do_not_block();
    peer_.encrypted = stream_.encrypted();
}

void ClientSession::stop() noexcept {
    phase_ = Phase::closed;
    error_code ignored;
    stream_.close();
    deadline_.cancel(ignored);
    status_timer_.cancel(ignored);
    turn_timer_.cancel(ignored);
    pace_timer_.cancel(ignored);
    // An answer that is still to come keeps this object alive. It must not keep frames.
    message_.finish();
    compressed_.reset();
}

/// Returns whether a client that sends nothing stays connected.
bool ClientSession::waits_for_something() const {
    return wanted() != 0 || subscription_.keeps_one() || wants_sensors() || wants_status_ || answer_pending_ ||
           clients_.something_goes_on_for(id_);
}

void ClientSession::watch() {
    if (!is_open()) {
        return;
    }
    const ClientRules& rules = clients_.rules();
    if (!peer_.local && has_vanished(stream_.native_handle(), rules.liveness)) {
        close(fmt::format("connection lost: its machine has not answered for {} s",
                          rules.liveness.longest_silence().count()));
        return;
    }
    const auto now = std::chrono::steady_clock::now();
    if (!greeted_ || waits_for_something()) {
        last_request_ = now;
    } else if (rules.idle_timeout.count() > 0 && now - last_request_ >= rules.idle_timeout) {
        send_error(
            fmt::format(
                "nothing was asked for {:g} s and nothing is subscribed to: connect again when there is something "
                "to ask, or raise [socket] idle_timeout_s",
                std::chrono::duration<double>(rules.idle_timeout).count()),
            true);
    }
    if (greeted_) {
        pump();  // a frame may have waited for room in the system's buffers, and none followed
    }
}

void ClientSession::failed() noexcept {
    try {
        close("closed: " + base::failure_text(std::current_exception()));
    } catch (...) {
        close("closed: out of memory");
    }
}

/// Marks a question as open. Whoever can answer it holds the result; it expires when the answer is lost.
std::shared_ptr<void> ClientSession::ask() {
    const std::shared_ptr<void> question = std::make_shared<char>();
    question_ = question;
    answer_pending_ = true;
    return question;
}

void ClientSession::look_for_answer() noexcept {
    if (answer_pending_ && question_.expired()) {
        close("closed: there was no memory for the answer to its question");
    }
}

void ClientSession::add_to(v1::Totals& totals) const noexcept {
    totals.set_clients(totals.clients() + (greeted_ ? 1 : 0));
    totals.set_client_frames_sent(totals.client_frames_sent() + subscription_.feed().frames_sent());
    totals.set_client_frames_skipped(totals.client_frames_skipped() + subscription_.feed().frames_skipped());
    totals.set_client_bytes_sent(totals.client_bytes_sent() + bytes_sent_);
}

v1::ClientStatus ClientSession::status() {
    v1::ClientStatus status;
    status.set_name(name_);
    status.set_address(peer_.address);
    status.set_frames_sent(subscription_.feed().frames_sent());
    status.set_frames_skipped(subscription_.feed().frames_skipped());
    status.set_bytes_sent(bytes_sent_);
    status.set_compressed_bytes(account().bytes());
    const auto compressing = std::chrono::duration_cast<std::chrono::microseconds>(account().time());
    status.set_compressor_us(static_cast<std::uint64_t>(compressing.count()));
    status.set_compressor_share(account().share(std::chrono::steady_clock::now()));
    return status;
}

std::string ClientSession::label() const {
    const std::string certificate =
        peer_.certificate ? ", certificate " + base::printable(*peer_.certificate, max_name) : "";
    return fmt::format("client {} ({}{}{}{})", id_, name_, name_.empty() ? "" : ", ", peer_.address, certificate);
}

void ClientSession::read_length() {
    if (!may_read() || reading_ || answer_pending_ || answers_.size() >= max_answers) {
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
    pace_timer_.async_wait(handler([](ClientSession& self, error_code error) {
        if (!error && self.may_read()) {
            self.await_length();
        }
    }));
}

void ClientSession::await_length() {
    asio::async_read(stream_, asio::buffer(length_),
                     handler([](ClientSession& self, error_code error, std::size_t) { self.length_arrived(error); }));
}

void ClientSession::length_arrived(const error_code& error) {
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
        length = proto::decode_length(length_);
    } catch (const std::invalid_argument& refused) {
        send_error(refused.what(), true);
        return;
    }
    read_message(length);
}

void ClientSession::read_message(std::uint32_t length) {
    reading_ = true;
    incoming_.clear();
    // The buffer grows with the bytes that arrive: a client may announce more than it sends.
    asio::async_read(stream_, asio::dynamic_buffer(incoming_, length), asio::transfer_exactly(length),
                     handler([](ClientSession& self, error_code error, std::size_t) {
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

void ClientSession::message_arrived() {
    requests_.take(static_cast<std::int64_t>(incoming_.size() / ClientRules::bytes_of_one));
    v1::Envelope message;
    try {
        proto::decode(incoming_, message);
        incoming_.clear();
        incoming_.shrink_to_fit();
        if (message.payload_bytes() != 0) {
            send_error(fmt::format("a message announces a payload of {} bytes, allowed: 0", message.payload_bytes()),
                       true);
        } else {
            if (!message.has_ready() && !message.has_ping()) {
                last_request_ = std::chrono::steady_clock::now();
            }
            handle(message);
        }
    } catch (const std::invalid_argument& refused) {
        send_error(refused.what(), true);
    }
    read_length();
}

void ClientSession::handle(const v1::Envelope& message) {
    if (!greeted_ && !message.has_hello()) {
        send_error("the first message must be Hello", true);
        return;
    }
    if (const Request* const request = clients_.request(message.body_case())) {
        pass_on(*request, message);
        return;
    }
    const auto allowed = [this] { return "hello, subscribe, " + clients_.names_of_requests() + ", ready, ping"; };
    switch (message.body_case()) {
        case v1::Envelope::kHello: hello(message.hello()); break;
        case v1::Envelope::kSubscribe: subscribe(message.subscribe()); break;
        case v1::Envelope::kReady: add_credit(message.ready()); break;
        case v1::Envelope::kPing: answer_ping(message.ping()); break;
        case v1::Envelope::BODY_NOT_SET:  // a newer client, which works without the answer
            send_error(fmt::format("Envelope: no message that disparityd {} knows, allowed: {}", DISPARITYD_VERSION,
                                   allowed()),
                       false);
            break;
        default:
            send_error(fmt::format("message {} of Envelope is not for clients to send, allowed: {}",
                                   static_cast<int>(message.body_case()), allowed()),
                       true);
    }
}

void ClientSession::hello(const v1::Hello& hello) {
    if (greeted_) {
        send_error("Hello came twice", true);
        return;
    }
    if (hello.protocol_version() != proto::protocol_version) {
        send_error(fmt::format(
                       "the client speaks protocol version {}, this daemon speaks {}: use a client of the same release",
                       hello.protocol_version(), proto::protocol_version),
                   true);
        return;
    }
    name_ = base::printable(hello.client_name(), max_name);
    if (!admit(hello.token())) {
        return;
    }
    greeted_ = true;
    client_id_ = hello.client_id();
    deadline_.cancel();
    v1::Envelope answer;
    v1::Welcome& welcome = *answer.mutable_welcome();
    const StreamLayout& layout = clients_.layout();
    welcome.set_protocol_version(proto::protocol_version);
    welcome.set_server_version(DISPARITYD_VERSION);
    *welcome.mutable_geometry() = to_message(layout.geometry);
    for (const v1::Product product : layout.products) {
        welcome.add_products(product);
    }
    welcome.set_shared_memory(layout.shared_memory);
    welcome.set_monotonic_ns(proto::monotonic_ns());
    send(std::move(answer));
    clients_.came_back(*this);
    clients_.log().unsubscribed.write(LogLevel::debug, label() + ": connected");
}

void ClientSession::subscribe(const v1::Subscribe& wanted) {
    const StreamLayout& layout = clients_.layout();
    if (const std::string wrong = ClientSubscription::problem(wanted, layout); !wrong.empty()) {
        send_error("Subscribe: " + wrong, false);
        return;
    }
    static_cast<void>(subscription_.take_kept());  // this one replaces it
    if (layout.products.empty()) {                 // the first source is being prepared: its products are not known
        subscription_.keep(wanted);
        send_status_every(wanted.status_interval_s());
        return;
    }
    subscription_.start(wanted, clients_.frames(), clients_.sensors());
    outdated_ = compressing_;
    compressed_.reset();
    clients_.subscription_changed();
    send_status_every(wanted.status_interval_s());
    if (!has_subscribed_ && (this->wanted() != 0 || wants_sensors() || wants_status_)) {
        has_subscribed_ = true;
        clients_.log().connections.write(LogLevel::info, label() + ": subscribed");
    }
}

void ClientSession::send_status_every(double seconds) {
    status_timer_.cancel();
    wants_status_ = seconds > 0;
    if (!is_open() || seconds <= 0) {
        return;
    }
    const auto interval = std::chrono::milliseconds(
        static_cast<std::int64_t>(std::clamp(seconds, 0.1, ClientSubscription::longest_status_interval_s) * 1000));
    status_timer_.expires_after(interval);
    status_timer_.async_wait(handler([seconds](ClientSession& self, error_code error) {
        if (error || !self.is_open()) {
            return;
        }
        if (self.answers_.empty()) {  // a client that does not read gets no queue of them
            v1::Envelope message;
            *message.mutable_status() = self.clients_.status();
            self.send(std::move(message));
        }
        self.send_status_every(seconds);
    }));
}

void ClientSession::pass_on(const Request& request, const v1::Envelope& message) {
    if (request.changes_something && request.changes_something(message) && !may_control(request.word)) {
        return;
    }
    request.handle(message, {id_, peer_.owns_daemon()}, reply());
}

/// Returns what takes the answer to the request that has arrived, in whatever thread it comes.
Reply ClientSession::reply() {
    return [self = shared_from_this(), question = ask(), thread = stream_.get_executor()](Answer answer) {
        asio::dispatch(thread, [self, question, answer = std::move(answer)]() mutable {
            self->guarded([&] { self->answer(std::move(answer)); });
            self->clients_.answered(self->id_);
        });
    };
}

void ClientSession::answer(Answer answer) {
    answer_pending_ = false;
    if (!answer.refusal.empty()) {
        send_error(answer.refusal, false);
    }
    for (v1::Envelope& message : answer.messages) {
        send(std::move(message));
    }
    read_length();
}

void ClientSession::answer_ping(const v1::Ping& ping) {
    limit_apart_from_requests();
    v1::Envelope answer;
    answer.mutable_pong()->set_client_ns(ping.client_ns());
    answer.mutable_pong()->set_monotonic_ns(proto::monotonic_ns());
    send(std::move(answer));
}

/// A client may send Ready with every frame, and still ask as much as others.
void ClientSession::limit_apart_from_requests() {
    requests_.give_back();
    credits_.take();
}

void ClientSession::make_room_for(const ClientSession& newer) noexcept {
    const bool same_client = id_ != newer.id_ && greeted_ && client_id_ != 0 && client_id_ == newer.client_id_;
    if (same_client && is_open() && peer_.local == newer.peer_.local && peer_.user == newer.peer_.user &&
        peer_.certificate == newer.peer_.certificate && token_ == newer.token_) {
        close("closed: its client has connected anew");
    }
}

void ClientSession::layout_changed() {
    if (!is_open()) {
        return;
    }
    if (const auto kept = subscription_.take_kept()) {
        const FrameCredit given = subscription_.credit();
        subscribe(*kept);
        subscription_.credit() = given;
    }
    if (subscription_.drop_products_not_in(clients_.layout().products)) {
        clients_.subscription_changed();
        send_error("a subscribed product is no longer served since the daemon was reconfigured", false);
    }
}

void ClientSession::close(std::string_view why) noexcept {
    if (phase_ == Phase::closed) {
        return;
    }
    stop();
    try {
        (has_subscribed_ ? clients_.log().connections : clients_.log().unsubscribed)
            .write(has_subscribed_ ? LogLevel::info : LogLevel::debug,
                   fmt::format("{}: {}; frames: {} sent, {} skipped", label(), why, subscription_.feed().frames_sent(),
                               subscription_.feed().frames_skipped()));
    } catch (...) {
        log_caught("a client is closed");
    }
    clients_.closed(id_);
}

}  // namespace disparityd::daemon
