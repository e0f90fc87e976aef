// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/client_session.h"

#include <algorithm>
#include <utility>

#include <boost/asio/dispatch.hpp>
#include <fmt/format.h>
#include <linux/sockios.h>
#include <sys/ioctl.h>

#include "base/failure_text.h"
#include "base/message_text.h"
#include "daemon/socket/clients.h"
#include "proto/framing.h"
#include "proto/monotonic_clock.h"

namespace disparityd::daemon {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

constexpr std::size_t max_name = 64;  ///< bytes shown
/// Passes before a wrong token is told: guessing is slow, and a right token waits for nobody.
constexpr std::chrono::seconds pause_after_wrong_token{1};
constexpr std::chrono::seconds stall_limit{2};

/// So many frames may lie in the system's buffers for a client that gives no credit.
constexpr std::size_t frames_in_buffers = 4;

/// Returns the bytes that the system still holds for the client: over TCP those not sent yet, on the Unix socket those
/// not read yet, with the system's own bytes around them. What lies unread at another machine is not known here.
std::size_t held_by_system(int socket, bool local) {
    int bytes = 0;
    return ::ioctl(socket, local ? SIOCOUTQ : SIOCOUTQNSD, &bytes) == 0 && bytes > 0 ? static_cast<std::size_t>(bytes)
                                                                                     : 0;
}

}  // namespace

ClientSession::ClientSession(ClientStream stream, ClientPeer peer, std::uint64_t id, Clients& clients)
    : ClientConnection(std::move(stream), clients),
      peer_(std::move(peer)),
      id_(id),
      status_timer_(this->stream().get_executor()) {
    peer_.encrypted = this->stream().encrypted();
}

void ClientSession::shook_hands() {
    peer_.certificate = stream().certificate();
}

void ClientSession::speaks_no_tls() {
    peer_.encrypted = false;
}

/// Returns whether a client that sends nothing stays connected.
bool ClientSession::waits_for_something() const {
    return wanted() != 0 || subscription_.keeps_one() || wants_sensors() || wants_status_ || answer_pending_ ||
           clients().something_goes_on_for(id_);
}

void ClientSession::watch() {
    if (!is_open()) {
        return;
    }
    const ClientRules& rules = clients().rules();
    if (!peer_.local && has_vanished(stream().native_handle(), rules.liveness)) {
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

void ClientSession::add_to(v1::Totals& totals) const noexcept {
    totals.set_clients(totals.clients() + (greeted_ ? 1 : 0));
    totals.set_client_frames_sent(totals.client_frames_sent() + subscription_.feed().frames_sent());
    totals.set_client_frames_skipped(totals.client_frames_skipped() + subscription_.feed().frames_skipped());
    totals.set_client_bytes_sent(totals.client_bytes_sent() + outbox().bytes_sent());
}

v1::ClientStatus ClientSession::status() {
    v1::ClientStatus status;
    status.set_name(name_);
    status.set_address(peer_.address);
    status.set_frames_sent(subscription_.feed().frames_sent());
    status.set_frames_skipped(subscription_.feed().frames_skipped());
    status.set_bytes_sent(outbox().bytes_sent());
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

void ClientSession::arrived(const v1::Envelope& message) {
    if (!message.has_ready() && !message.has_ping()) {
        last_request_ = std::chrono::steady_clock::now();
    }
    if (const Request* const request = clients().request(message.body_case())) {
        pass_on(*request, message);
        return;
    }
    const auto allowed = [this] { return "hello, subscribe, " + clients().names_of_requests() + ", ready, ping"; };
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
    become_ready();
    v1::Envelope answer;
    v1::Welcome& welcome = *answer.mutable_welcome();
    const StreamLayout& layout = clients().layout();
    welcome.set_protocol_version(proto::protocol_version);
    welcome.set_server_version(DISPARITYD_VERSION);
    *welcome.mutable_geometry() = to_message(layout.geometry);
    for (const v1::Product product : layout.products) {
        welcome.add_products(product);
    }
    welcome.set_shared_memory(layout.shared_memory);
    welcome.set_monotonic_ns(proto::monotonic_ns());
    send(answer);
    clients().came_back(*this);
    clients().log().unsubscribed.write(LogLevel::debug, label() + ": connected");
}

bool ClientSession::make_place() noexcept {
    if (greeted_) {
        return false;
    }
    close("closed: it had not said hello, and another client needs its place");
    return true;
}

void ClientSession::access_changed() {
    if (!greeted_ || !is_open()) {
        return;
    }
    if (const std::string why = why_refused(token_); !why.empty()) {
        send_error("since the daemon was reconfigured: " + why, true);
    }
}

/// Returns why the client may not look; empty: it may. The rules may be newer than the handshake.
std::string ClientSession::why_refused(const std::string& token) const {
    const ClientRules& rules = clients().rules();
    if (rules.access.right_of(peer_, token) == base::Right::none) {
        return rules.access.why_not_view(peer_, token);
    }
    if (stream().encrypted() && rules.access.certificates && !stream().would_be_taken_by(rules.tls)) {
        return "the certificate of this client is revoked, or of no authority in the file of [socket] client_authority";
    }
    return {};
}

/// Returns whether the client may look; else sends an Error, which a wrong token waits for.
bool ClientSession::admit(const std::string& token) {
    const std::string why = why_refused(token);
    if (why.empty()) {
        token_ = token;
        return true;
    }
    if (peer_.local || token.empty()) {
        send_error(why, true);
    } else {
        refuse_late(why);
    }
    return false;
}

void ClientSession::refuse_late(const std::string& why) {
    answer_pending_ = true;  // nothing is read meanwhile
    set_deadline(pause_after_wrong_token, [this, why] { send_error(why, true); });
}

/// Returns whether the client may do that; sends an Error if not.
bool ClientSession::may_control(std::string_view what) {
    const ClientAccess& access = clients().rules().access;
    if (access.right_of(peer_, token_) == base::Right::control) {
        return true;
    }
    send_error(fmt::format("{}: {}", what, access.why_not_control(peer_)), false);
    return false;
}

void ClientSession::subscribe(const v1::Subscribe& wanted) {
    const StreamLayout& layout = clients().layout();
    if (const std::string wrong = ClientSubscription::problem(wanted, layout); !wrong.empty()) {
        send_error("Subscribe: " + wrong, false);
        return;
    }
    if (layout.products.empty()) {  // the first source is being prepared: its products are not known
        subscription_.keep(wanted);
        send_status_every(wanted.status_interval_s());
        return;
    }
    subscription_.start(wanted, clients().frames(), clients().sensors());
    outdated_ = compressing_;
    outbox().drop_compressed();
    clients().subscription_changed();
    send_status_every(wanted.status_interval_s());
    if (!has_subscribed_ && (this->wanted() != 0 || wants_sensors() || wants_status_)) {
        has_subscribed_ = true;
        clients().log().connections.write(LogLevel::info, label() + ": subscribed");
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
    status_timer_.async_wait(handler([this, seconds](ClientConnection&, error_code error) {
        if (error || !is_open()) {
            return;
        }
        if (outbox().answers() == 0) {  // a client that does not read gets no queue of them
            v1::Envelope message;
            *message.mutable_status() = clients().status();
            send(message);
        }
        send_status_every(seconds);
    }));
}

void ClientSession::pass_on(const Request& request, const v1::Envelope& message) {
    if (request.changes_something && request.changes_something(message) && !may_control(request.word)) {
        return;
    }
    if (request.rate) {
        if (const std::chrono::duration<double> wait = request.rate->wait(); wait.count() > 0) {
            send_error(fmt::format("{}: asked for too often: ask again in {:.1f} s", request.word, wait.count()),
                       false);
            return;
        }
        request.rate->take();
    }
    request.handle(message, {id_, peer_.owns_daemon()}, reply(request.rate));
}

/// Returns what takes the answer to the request that has arrived, in whatever thread it comes.
Reply ClientSession::reply(std::shared_ptr<RateLimit> rate) {
    answer_pending_ = true;
    return [self = self(), thread = stream().get_executor(), rate](Answer answer) {
        asio::dispatch(thread, [self, rate, answer = std::move(answer)] {
            if (rate && !answer.refusal.empty()) {
                rate->give_back();
            }
            self->guarded([&] { self->answer(answer); });
            self->clients().answered(self->id_);
        });
    };
}

void ClientSession::answer(const Answer& answer) {
    answer_pending_ = false;
    if (!answer.refusal.empty()) {
        send_error(answer.refusal, false);
    }
    if (answer.held) {  // what an answer before holds may still be waiting
        outbox().hold(answer.held);
    }
    for (const v1::Envelope& message : answer.messages) {
        send(message);
    }
    read_length();
}

void ClientSession::answer_ping(const v1::Ping& ping) {
    limit_apart_from_requests();
    v1::Envelope answer;
    answer.mutable_pong()->set_client_ns(ping.client_ns());
    answer.mutable_pong()->set_monotonic_ns(proto::monotonic_ns());
    send(answer);
}

void ClientSession::add_credit(const v1::Ready& ready) {
    limit_apart_from_requests();
    subscription_.credit().add(ready.frames());
    ask_for_compressed();
    pump();
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
    if (subscription_.drop_products_not_in(clients().layout().products)) {
        clients().subscription_changed();
        send_error("a subscribed product is no longer served since the daemon was reconfigured", false);
    }
}

void ClientSession::frame_arrived() {
    if (!may_write()) {
        return;
    }
    if (wanted() != 0 && outbox().stalls(stall_limit)) {
        clients().log().slow_clients.write(
            LogLevel::warning, fmt::format("{}: a message to it takes longer than {} s: it reads too slowly; "
                                           "it stays connected, frames are skipped for it",
                                           label(), stall_limit.count()));
    }
    ask_for_compressed();
    pump();
}

void ClientSession::sensors_arrived() {
    pump();
}

bool ClientSession::start_next() {
    return take_sensors() || take_frame();
}

/// Starts a message with all new samples. They go before the next frame: a client that skips frames gets all samples.
bool ClientSession::take_sensors() {
    if (!wants_sensors() || !subscription_.has_samples(clients().sensors())) {
        return false;
    }
    v1::Envelope message;
    subscription_.take_samples(clients().sensors(), *message.mutable_sensors());
    outbox().start(message);
    return true;
}

/// Takes the next frame, with the selection for it. The frame is null if there is none, or the client is told that its
/// region lies outside of it.
FrameCompressor::Request ClientSession::take_request() {
    ClientSubscription::Taken taken = subscription_.take_frame(clients().frames());
    if (taken.region_is_outside) {
        clients().subscription_changed();
        send_error("the subscribed region lies outside of the image since the daemon was reconfigured: subscribe again",
                   false);
    }
    return std::move(taken.request);
}

FrameCompressor::Request ClientSession::next_request() noexcept {
    outdated_ = false;
    FrameCompressor::Request next;
    guarded([&] {
        if (wanted() != 0 && subscription_.compressed() && may_compress()) {
            next = take_request();
        }
    });
    if (!next.frame) {
        compressing_ = false;
    }
    return next;
}

bool ClientSession::same_request(const FrameCompressor::Request& request) const noexcept {
    return wanted() != 0 && may_compress() && subscription_.selection() == request.selection &&
           subscription_.feed().would_take(clients().frames(), request.frame);
}

bool ClientSession::take_frame() {
    if (wanted() == 0) {
        return false;
    }
    if (holds_back()) {
        return false;
    }
    if (subscription_.compressed()) {
        return take_compressed();
    }
    if (!subscription_.credit().allows_one()) {
        return false;
    }
    const FrameCompressor::Request next = take_request();
    if (!next.frame) {
        return false;
    }
    std::shared_ptr<const EncodedPlanes> planes;
    try {
        planes = clients().frames().encoded(next.frame, next.selection);
    } catch (const std::exception& error) {
        send_error(base::failure_text(error), true);
        return false;
    }
    outbox().start_frame(make_head(next, *planes), planes);
    return true;
}

/// Starts the message with the compressed frame, if there is one, and asks for the next one at once: a client that
/// asked only after this one was sent would lose its turn. One that gives credit asks when this one is written.
bool ClientSession::take_compressed() {
    const bool taken = outbox().start_compressed();
    if (!taken || !subscription_.credit().limited()) {
        ask_for_compressed();
    }
    return taken;
}

/// Returns whether the next frame may be compressed now. For a client that gives credit none is while a message is
/// being written: it would grow old behind that one.
bool ClientSession::may_compress() const {
    return subscription_.credit().allows_one() && (!subscription_.credit().limited() || !outbox().writing());
}

void ClientSession::ask_for_compressed() {
    if (wanted() != 0 && subscription_.compressed() && may_compress() && !compressing_ && !outbox().has_compressed() &&
        subscription_.feed().has_next(clients().frames())) {
        compressing_ = true;
        clients().compressor().ask(self());
    }
}

void ClientSession::compressed(const FrameCompressor::Request& request,
                               std::shared_ptr<const EncodedPlanes> planes) noexcept {
    compressing_ = false;
    if (!is_open()) {
        return;
    }
    guarded([&] {
        if (!std::exchange(outdated_, false)) {
            v1::Envelope head = make_head(request, *planes);
            outbox().keep_compressed(std::move(head), request.frame->captured, std::move(planes));
        }
        pump();
    });
}

void ClientSession::not_compressed(const std::string& why) noexcept {
    compressing_ = false;
    guarded([&] { send_error(why, true); });
}

/// Returns the head of the frame's message and counts the frame as sent.
v1::Envelope ClientSession::make_head(const FrameCompressor::Request& request, const EncodedPlanes& planes) {
    return frame_head(*request.frame, request.selection, planes,
                      subscription_.feed().count_sent(request.frame->info.publish_index));
}

/// Returns whether the next frame waits: a client that gives no credit would get it behind frames of the past. The next
/// one that is published asks again, and watch() where none comes.
bool ClientSession::holds_back() {
    return !subscription_.credit().limited() && outbox().frame_bytes() != 0 &&
           held_by_system(stream().native_handle(), peer_.local) > frames_in_buffers * outbox().frame_bytes();
}

void ClientSession::stopped() noexcept {
    error_code ignored;
    status_timer_.cancel(ignored);
}

void ClientSession::left(std::string_view why) noexcept {
    (has_subscribed_ ? clients().log().connections : clients().log().unsubscribed)
        .write(has_subscribed_ ? LogLevel::info : LogLevel::debug,
               fmt::format("{}: {}; frames: {} sent, {} skipped", label(), why, subscription_.feed().frames_sent(),
                           subscription_.feed().frames_skipped()));
    clients().closed(id_);
}

}  // namespace disparityd::daemon
