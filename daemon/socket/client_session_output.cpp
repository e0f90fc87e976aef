// SPDX-License-Identifier: Apache-2.0
//
// The output of a session: which message is written next, which frame, what keeps frames fresh, and how the connection
// ends.
#include <algorithm>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <fmt/format.h>
#include <linux/sockios.h>
#include <sys/ioctl.h>

#include "base/failure_text.h"
#include "daemon/socket/client_session.h"
#include "daemon/socket/clients.h"
#include "proto/framing.h"
#include "proto/monotonic_clock.h"
#include "proto/text.h"

namespace disparityd::daemon {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

constexpr std::chrono::seconds close_timeout{1};
constexpr std::chrono::seconds stall_limit{2};
constexpr std::string_view lost_frame = "closed: there was no memory to keep the rest of its frame";

/// Says how old the frame is, and at which instant.
void set_age(v1::Frame& message, std::chrono::steady_clock::time_point captured) {
    const std::int64_t now = proto::monotonic_ns();
    message.set_sent_monotonic_ns(now);
    message.set_age_ns(now - std::chrono::nanoseconds(captured.time_since_epoch()).count());
}

/// Returns the message that precedes the bytes of a frame's planes.
v1::Envelope frame_head(const FrameCopy& frame, const Selection& selection, const EncodedPlanes& planes,
                        std::uint64_t skipped) {
    v1::Envelope message;
    v1::Frame& out = *message.mutable_frame();
    proto::fill(out, frame.info);
    set_age(out, frame.captured);
    if (selection.region.width != 0) {
        out.mutable_region()->set_x(selection.region.x);
        out.mutable_region()->set_y(selection.region.y);
        out.mutable_region()->set_width(selection.region.width);
        out.mutable_region()->set_height(selection.region.height);
    }
    out.set_skipped_for_client(skipped);
    for (const v1::PlaneInfo& plane : planes.planes) {
        *out.add_planes() = plane;
    }
    message.set_payload_bytes(planes.bytes.size());
    return message;
}

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

void ClientSession::send(v1::Envelope message) {
    if (!is_open()) {
        return;
    }
    proto::encode(message, answers_.emplace_back());
    pump();
}

void ClientSession::send_error(const std::string& why, bool closing) {
    if (phase_ == Phase::deaf && closing) {
        close("closed: " + why);
    }
    if (!is_open()) {
        return;
    }
    v1::Envelope message;
    message.mutable_error()->set_message(proto::to_valid_utf8(why));
    message.mutable_error()->set_closing(closing);
    proto::encode(message, answers_.emplace_back());
    clients_.log().errors.write(LogLevel::warning,
                                fmt::format("{}: {}: {}", label(), closing ? "closed" : "refused", why));
    if (closing) {
        phase_ = Phase::leaving;
        clients_.subscription_changed();
        close_later();
    }
    pump();
}

/// Ends the connection even if its last message cannot be written.
void ClientSession::close_later() {
    deadline_.expires_after(close_timeout);
    deadline_.async_wait(handler([](ClientSession& self, error_code error) {
        if (!error) {
            self.close("closed after an error");
        }
    }));
}

void ClientSession::frame_arrived() {
    if (!may_write()) {
        return;
    }
    if (message_.is_lost()) {
        close(lost_frame);
        return;
    }
    if (writing_ && !stall_logged_ && wanted() != 0 &&
        std::chrono::steady_clock::now() - write_started_ > stall_limit) {
        stall_logged_ = true;
        clients_.log().slow_clients.write(
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

void ClientSession::pump() {
    while (may_write() && !writing_) {
        if (!answers_.empty()) {
            message_.start() = std::move(answers_.front());
            answers_.pop_front();
        } else if (phase_ == Phase::leaving) {
            end_output();
            return;
        } else if (!take_sensors() && !take_frame()) {
            break;
        }
        write();
    }
    read_length();  // there may be room for answers again
}

/// Starts a message with all new samples. They go before the next frame: a client that skips frames gets all samples.
bool ClientSession::take_sensors() {
    v1::Envelope message;
    if (!wants_sensors() || !subscription_.has_samples(clients_.sensors()) ||
        !subscription_.take_samples(clients_.sensors(), *message.mutable_sensors())) {
        return false;
    }
    proto::encode(message, message_.start());
    return true;
}

/// Takes the next frame, with the selection for it. The frame is null if there is none, or the client is told that its
/// region lies outside of it.
FrameCompressor::Request ClientSession::take_request() {
    ClientSubscription::Taken taken = subscription_.take_frame(clients_.frames());
    if (taken.region_is_outside) {
        clients_.subscription_changed();
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
           subscription_.feed().would_take(clients_.frames(), request.frame);
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
        planes = clients_.frames().encoded(next.frame, next.selection);
    } catch (const std::exception& error) {
        send_error(base::failure_text(error), true);
        return false;
    }
    proto::encode(make_head(next, *planes), message_.start(planes));
    frame_bytes_ = message_.size();
    return true;
}

/// Starts the message with the compressed frame, if there is one, and asks for the next one at once: a client that
/// asked only after this one was sent would lose its turn. One that gives credit asks when this one is written.
bool ClientSession::take_compressed() {
    const bool taken = compressed_ != nullptr;
    if (taken) {
        v1::Envelope head = std::move(compressed_head_);
        set_age(*head.mutable_frame(), compressed_captured_);  // it may have waited for the previous message
        proto::encode(head, message_.start(std::exchange(compressed_, nullptr)));
        frame_bytes_ = message_.size();
    }
    if (!taken || !subscription_.credit().limited()) {
        ask_for_compressed();
    }
    return taken;
}

/// Returns whether the next frame may be compressed now. For a client that gives credit none is while a message is
/// being written: it would grow old behind that one.
bool ClientSession::may_compress() const {
    return subscription_.credit().allows_one() && (!subscription_.credit().limited() || !writing_);
}

void ClientSession::ask_for_compressed() {
    if (wanted() != 0 && subscription_.compressed() && may_compress() && !compressing_ && !compressed_ &&
        subscription_.feed().has_next(clients_.frames())) {
        compressing_ = true;
        clients_.compressor().ask(shared_from_this());
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
            compressed_head_ = make_head(request, *planes);
            compressed_captured_ = request.frame->captured;
            compressed_ = std::move(planes);
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

void ClientSession::write() {
    writing_ = true;
    write_started_ = std::chrono::steady_clock::now();
    write_some();
}

/// Writes as much as the socket takes at once. Asio holds no address of the message between two writes, so the planes
/// may move (Payload::keep_copy()).
void ClientSession::write_some() {
    if (message_.is_lost()) {
        close(lost_frame);
        return;
    }
    error_code error;
    message_.sent(stream_.write_some(message_.rest(), error));
    if (error && error != asio::error::would_block && error != asio::error::interrupted) {
        output_failed("connection lost: " + stream_.reason(error));
    } else if (message_.is_done()) {
        writing_ = false;
        stall_logged_ = false;
        bytes_sent_ += message_.size();
        message_.finish();
    } else {
        await_writable();
    }
}

void ClientSession::await_writable() {
    stream_.async_wait_writable(handler([](ClientSession& self, error_code error) {
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

/// A client that has gone may have asked for something in its last moment, such as the end of a recording: what lies in
/// the socket is read and done before the connection is closed.
void ClientSession::output_failed(const std::string& why) {
    if (!is_open() || !greeted_) {
        close(why);
        return;
    }
    phase_ = Phase::deaf;
    writing_ = false;
    message_.finish();
    compressed_.reset();
    answers_.clear();
    clients_.subscription_changed();
    // Reading finds the end of what the client has sent. One that keeps its connection half open, or asked for what
    // takes long, gets no more than this time.
    deadline_.expires_after(close_timeout);
    deadline_.async_wait(handler([](ClientSession& self, error_code error) {
        if (!error && self.phase_ == Phase::deaf) {
            self.close("left");
        }
    }));
    read_length();
}

/// Tells the client, once, that nothing follows its last message, and lets it read that one.
void ClientSession::end_output() {
    if (std::exchange(output_ended_, true)) {
        return;
    }
    stream_.end_output();
    drain();
}

/// Reads until the client closes: the system throws the last message away if input is unread at a close.
void ClientSession::drain() {
    stream_.async_discard(asio::buffer(discarded_), handler([](ClientSession& self, error_code error, std::size_t) {
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

void ClientSession::add_credit(const v1::Ready& ready) {
    limit_apart_from_requests();
    subscription_.credit().add(ready.frames());
    ask_for_compressed();
    pump();
}

/// Returns whether the next frame waits: a client that gives no credit would get it behind frames of the past. The next
/// one that is published asks again, and watch() where none comes.
bool ClientSession::holds_back() {
    return !subscription_.credit().limited() && frame_bytes_ != 0 &&
           held_by_system(stream_.native_handle(), peer_.local) > frames_in_buffers * frame_bytes_;
}

}  // namespace disparityd::daemon
