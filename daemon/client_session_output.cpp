// SPDX-License-Identifier: Apache-2.0
//
// The way out of a session: what is written next, which frame it is, and how a connection ends.
#include <algorithm>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>

#include "daemon/client_session.h"
#include "proto/framing.h"
#include "proto/text.h"

namespace disparityd {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

constexpr std::chrono::seconds close_timeout{1};
constexpr std::chrono::seconds stall_limit{2};

/// What a client is told of a frame before the bytes of its planes.
v1::Envelope frame_head(const FrameCopy& frame, const Selection& selection, const EncodedPlanes& planes,
                        std::uint64_t skipped) {
    const proto::ShmFrame& info = frame.info;
    v1::Envelope message;
    v1::Frame& out = *message.mutable_frame();
    out.set_sequence(info.sequence);
    out.set_monotonic_ns(info.monotonic_ns);
    out.set_realtime_ns(info.realtime_ns);
    out.set_age_ns((std::chrono::steady_clock::now() - frame.captured).count());
    *out.mutable_geometry() = to_message(info);
    if (selection.region.width != 0) {
        out.mutable_region()->set_x(selection.region.x);
        out.mutable_region()->set_y(selection.region.y);
        out.mutable_region()->set_width(selection.region.width);
        out.mutable_region()->set_height(selection.region.height);
    }
    out.set_flags(info.flags);
    out.set_dropped_before(info.dropped_before);
    out.set_skipped_for_client(skipped);
    out.set_publish_index(info.publish_index);
    for (const v1::PlaneInfo& plane : planes.planes) {
        *out.add_planes() = plane;
    }
    message.set_payload_bytes(planes.bytes.size());
    return message;
}

}  // namespace

void ClientSession::send(v1::Envelope message) {
    if (closed_ || closing_) {
        return;
    }
    proto::encode(message, answers_.emplace_back());
    pump();
}

void ClientSession::send_error(const std::string& why, bool closing) {
    if (closed_ || closing_) {
        return;
    }
    v1::Envelope message;
    message.mutable_error()->set_message(proto::text(why));
    message.mutable_error()->set_closing(closing);
    proto::encode(message, answers_.emplace_back());
    host_.log().broke_the_protocol.write(LogLevel::warning,
                                         fmt::format("{}: {}: {}", label(), closing ? "closed" : "refused", why));
    if (closing) {
        closing_ = true;
        host_.subscription_changed();
        // Whether the message gets through or not, the connection ends now.
        deadline_.expires_after(close_timeout);
        deadline_.async_wait([self = shared_from_this()](error_code error) {
            if (!error) {
                self->close("closed after an error");
            }
        });
    }
    pump();
}

void ClientSession::frame_arrived() {
    if (writing_ && !stall_logged_ && wanted() != 0 &&
        std::chrono::steady_clock::now() - write_started_ > stall_limit) {
        stall_logged_ = true;
        host_.log().fell_behind.write(
            LogLevel::warning, fmt::format("{}: has not read for {} s: it stays connected, frames are skipped for it",
                                           label(), stall_limit.count()));
    }
    pump();
}

void ClientSession::sensors_arrived() {
    pump();
}

void ClientSession::pump() {
    if (closed_ || writing_) {
        return;
    }
    if (!answers_.empty()) {
        head_ = std::move(answers_.front());
        answers_.pop_front();
        write();
    } else if (closing_) {
        drain();
    } else if (take_sensors() || take_frame()) {
        write();
    }
}

/// They are small: whoever reads frames too slowly gets all samples between two of them.
bool ClientSession::take_sensors() {
    if (!wants_sensors() || next_sample_ == host_.sensors().end()) {
        return false;
    }
    v1::Envelope message;
    next_sample_ = host_.sensors().fill(next_sample_, *message.mutable_sensors());
    proto::encode(message, head_);
    return true;
}

/// The next frame that the client wants now, by products and rate; the rest is left behind.
FrameHandle ClientSession::next_frame() {
    while (FrameHandle frame = host_.frames().next(next_index_)) {
        next_index_ = frame->info.publish_index + 1;
        const std::uint32_t wanted_products = wanted();
        if ((frame->products & wanted_products) != wanted_products) {
            continue;
        }
        if (max_rate_ > 0) {
            const auto interval = std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                std::chrono::duration<double>(1.0 / std::max(max_rate_, 1e-6)));
            // Frames that come a little early for their turn keep the rate from falling to half of it.
            if (frame->published + interval / 20 < next_due_) {
                continue;
            }
            const bool late = frame->published > next_due_ + interval;
            next_due_ = (late ? frame->published : next_due_) + interval;
        }
        return frame;
    }
    return nullptr;
}

/// After a reload the image may be smaller than the region: what is left of it. False when nothing is.
bool ClientSession::clamp_region(const FrameCopy& frame, Selection& selection) {
    auto& region = selection.region;
    if (region_problem(region, frame.info.width, frame.info.height).empty()) {
        return true;
    }
    if (region.x >= frame.info.width || region.y >= frame.info.height) {
        return false;
    }
    region.width = std::min(region.width, frame.info.width - region.x);
    region.height = std::min(region.height, frame.info.height - region.y);
    return true;
}

/// The frame that comes next, and what of it; no frame where there is none, or nothing is left of the region.
FrameCompressor::Wish ClientSession::wish() {
    FrameCompressor::Wish wish{next_frame(), selection_};
    if (wish.frame && !clamp_region(*wish.frame, wish.selection)) {
        wish.frame = nullptr;
        selection_ = {};
        host_.subscription_changed();
        send_error(
            "the subscribed region lies outside of the image since the daemon was configured anew: subscribe again",
            false);
    }
    return wish;
}

FrameCompressor::Wish ClientSession::next_wish() {
    outdated_ = false;
    const bool wants_some = !closed_ && wanted() != 0 && selection_.encoding == v1::ZSTD;
    FrameCompressor::Wish next = wants_some ? wish() : FrameCompressor::Wish{};
    if (!next.frame) {
        compressing_ = false;
    }
    return next;
}

bool ClientSession::would_wish(const FrameCompressor::Wish& wish) const {
    return !closed_ && wanted() != 0 && max_rate_ == 0 && selection_ == wish.selection &&
           host_.frames().next(next_index_) == wish.frame;
}

bool ClientSession::take_frame() {
    if (wanted() == 0) {
        return false;
    }
    if (selection_.encoding == v1::ZSTD) {
        return take_compressed();
    }
    const FrameCompressor::Wish next = wish();
    if (!next.frame) {
        return false;
    }
    try {
        planes_ = host_.frames().encoded(next.frame, next.selection);
    } catch (const std::exception& error) {
        send_error(error.what(), true);
        return false;
    }
    make_head(next, *planes_, head_);
    return true;
}

/// The frame that has been compressed meanwhile; without one, asks for the next.
bool ClientSession::take_compressed() {
    if (compressed_) {
        head_ = std::move(compressed_head_);
        planes_ = std::move(compressed_);
        compressed_.reset();
        return true;
    }
    if (!compressing_ && host_.frames().next(next_index_)) {
        compressing_ = true;
        host_.compressor().ask(shared_from_this());
    }
    return false;
}

void ClientSession::compressed(const FrameCompressor::Wish& wish, std::shared_ptr<const EncodedPlanes> planes) {
    compressing_ = false;
    if (closed_ || closing_) {
        return;
    }
    if (!std::exchange(outdated_, false)) {
        make_head(wish, *planes, compressed_head_);
        compressed_ = std::move(planes);
    }
    pump();
}

void ClientSession::not_compressed(const std::string& why) {
    compressing_ = false;
    send_error(why, true);
}

/// What is told of the frame, and that it has been sent.
void ClientSession::make_head(const FrameCompressor::Wish& wish, const EncodedPlanes& planes,
                              std::vector<std::uint8_t>& head) {
    const proto::ShmFrame& info = wish.frame->info;
    const std::uint64_t skipped = has_sent_ ? info.publish_index - last_sent_ - 1 : 0;
    proto::encode(frame_head(*wish.frame, wish.selection, planes, skipped), head);
    has_sent_ = true;
    last_sent_ = info.publish_index;
    frames_skipped_ += skipped;
    ++frames_sent_;
}

void ClientSession::write() {
    writing_ = true;
    write_started_ = std::chrono::steady_clock::now();
    const std::array<asio::const_buffer, 2> buffers{asio::buffer(head_),
                                                    planes_ ? asio::buffer(planes_->bytes) : asio::const_buffer()};
    const auto whole = [](const error_code& error, std::size_t) {
        return error ? std::size_t{0} : std::size_t{1} << 30;
    };
    asio::async_write(socket_, buffers, whole, [self = shared_from_this()](error_code error, std::size_t bytes) {
        self->writing_ = false;
        self->stall_logged_ = false;
        self->planes_.reset();
        self->bytes_sent_ += bytes;
        if (self->closed_) {
            return;
        }
        if (error) {
            self->close("connection lost: " + error.message());
            return;
        }
        self->pump();
        self->read_length();
    });
}

/// Lets the client read its last message: closing with unread input would make the system throw that away.
void ClientSession::drain() {
    error_code ignored;
    socket_.shutdown(Socket::shutdown_send, ignored);
    socket_.async_read_some(asio::buffer(discarded_), [self = shared_from_this()](error_code error, std::size_t) {
        if (self->closed_) {
            return;
        }
        if (error) {
            self->close("closed after an error");
        } else {
            self->drain();
        }
    });
}

}  // namespace disparityd
