// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/client_outbox.h"

#include <utility>

#include "daemon/socket/client_rules.h"
#include "proto/framing.h"
#include "proto/monotonic_clock.h"

namespace disparityd::daemon {
namespace {

/// Says how old the frame is, and at which instant.
void set_age(v1::Frame& message, std::chrono::steady_clock::time_point captured) {
    const std::int64_t now = proto::monotonic_ns();
    message.set_sent_monotonic_ns(now);
    message.set_age_ns(now - std::chrono::nanoseconds(captured.time_since_epoch()).count());
}

}  // namespace

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
    out.set_skipped(skipped);
    for (const v1::PlaneInfo& plane : planes.planes) {
        *out.add_planes() = plane;
    }
    message.set_payload_bytes(planes.bytes.size());
    return message;
}

void ClientOutbox::add(const v1::Envelope& answer) {
    proto::encode(answer, answers_.emplace_back());
    answer_bytes_ += answers_.back().size();
}

bool ClientOutbox::is_full() const {
    return answers_.size() >= ClientRules::max_answers || answer_bytes_ >= ClientRules::max_answer_bytes;
}

void ClientOutbox::begin() {
    writing_ = true;
    started_ = std::chrono::steady_clock::now();
}

bool ClientOutbox::start_answer() {
    if (answers_.empty()) {
        return false;
    }
    message_.start() = std::move(answers_.front());
    answers_.pop_front();
    answer_bytes_ -= message_.size();
    begin();
    return true;
}

void ClientOutbox::start(const v1::Envelope& message) {
    proto::encode(message, message_.start());
    begin();
}

void ClientOutbox::start_frame(const v1::Envelope& head, std::shared_ptr<const EncodedPlanes> planes) {
    proto::encode(head, message_.start(std::move(planes)));
    frame_bytes_ = message_.size();
    begin();
}

bool ClientOutbox::start_compressed() {
    if (!compressed_) {
        return false;
    }
    v1::Envelope head = std::move(compressed_head_);
    set_age(*head.mutable_frame(), compressed_captured_);  // it may have waited for the message before
    start_frame(head, std::exchange(compressed_, nullptr));
    return true;
}

void ClientOutbox::keep_compressed(v1::Envelope head, std::chrono::steady_clock::time_point captured,
                                   std::shared_ptr<const EncodedPlanes> planes) {
    compressed_head_ = std::move(head);
    compressed_captured_ = captured;
    compressed_ = std::move(planes);
}

bool ClientOutbox::sent(std::size_t bytes) {
    message_.sent(bytes);
    if (!message_.is_done()) {
        return false;
    }
    writing_ = false;
    stall_told_ = false;
    bytes_sent_ += message_.size();
    message_.finish();
    if (answers_.empty()) {
        held_.reset();
    }
    return true;
}

bool ClientOutbox::stalls(std::chrono::steady_clock::duration limit) {
    return writing_ && std::chrono::steady_clock::now() - started_ > limit && !std::exchange(stall_told_, true);
}

void ClientOutbox::release_frames() noexcept {
    message_.finish();
    compressed_.reset();
}

void ClientOutbox::clear() noexcept {
    release_frames();
    writing_ = false;
    answers_.clear();
    answer_bytes_ = 0;
    held_.reset();
}

}  // namespace disparityd::daemon
