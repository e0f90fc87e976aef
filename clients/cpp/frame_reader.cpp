// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/frame_reader.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "clients/cpp/frame_message.h"
#include "proto/monotonic_clock.h"

namespace disparity {
namespace {

namespace proto = disparityd::proto;
namespace v1 = disparityd::v1;

}  // namespace

void FrameReader::start(const Subscription& subscription) {
    max_rate_ = subscription.max_rate;
    wants_frames_ = !subscription.products.empty();
    start_again();
}

void FrameReader::start_again() {
    flow_.start(max_rate_);
    kept_.reset();
    problem_ = nullptr;
}

ReadResult FrameReader::read(Frame& frame, Deadline deadline, const Other& other) {
    flow_.reads(proto::monotonic_ns());
    if (kept_) {
        frame = std::move(*kept_);
        kept_.reset();
        has_frame_ = true;
    }
    bool refused = false;
    while (true) {
        const bool open = drain(frame, other);
        if (has_frame_) {
            has_frame_ = false;
            if (is_fresh(frame)) {
                connection_.keep_clock();  // where a frame is always there, nothing else asks
                return give(frame);
            }
            if (!std::exchange(refused, true)) {  // the daemon has the time to send a fresh one
                const std::chrono::nanoseconds patience(flow_.patience_ns());
                deadline = std::max(deadline, after(std::chrono::ceil<std::chrono::milliseconds>(patience)));
            }
        }
        if (problem_) {
            std::rethrow_exception(std::exchange(problem_, nullptr));
        }
        if (!open) {
            return ReadResult::gone;
        }
        give_credit(true);
        const auto outcome = connection_.listen(deadline, flow_.interval_ns());
        if (outcome != Connection::Outcome::done) {
            return outcome == Connection::Outcome::timeout ? ReadResult::timeout : ReadResult::gone;
        }
        take_message(frame, other);
    }
}

/// Takes all that lies in the socket; the newest frame counts. What is wrong behind a frame is told after it. Returns
/// whether the connection is still there.
bool FrameReader::drain(Frame& frame, const Other& other) {
    try {
        while (!problem_) {
            const auto outcome = connection_.receive(after(std::chrono::milliseconds(0)));
            if (outcome != Connection::Outcome::done) {
                return outcome == Connection::Outcome::timeout;
            }
            take_message(frame, other);
        }
    } catch (...) {
        problem_ = std::current_exception();
    }
    return true;
}

void FrameReader::take_message(Frame& frame, const Other& other) {
    if (!connection_.envelope().has_frame()) {
        other();
    } else if (!has_frame_) {
        known_ = take(frame);
        has_frame_ = true;
    } else {
        known_ = take(spare_);
        std::swap(frame, spare_);
    }
}

/// Unpacks the frame that the connection has received.
FrameReader::Known FrameReader::take(Frame& frame) {
    const v1::Frame& message = connection_.envelope().frame();
    try {
        take_over(frame, message, connection_.payload());
    } catch (const std::invalid_argument& error) {
        connection_.fail(std::string("sent a bad frame: ") + error.what());
    }
    Known known;
    known.age_ns = sane_ns(message.age_ns());
    known.sent_ns = connection_.by_credit() ? sane_ns(message.sent_monotonic_ns()) : 0;
    known.captured_ns = known.sent_ns - known.age_ns;
    known.came_ns = proto::monotonic_ns();
    known.empty_ns = connection_.empty_ns();
    flow_.arrived(arrival(frame, known));
    return known;
}

FrameFlow::Arrival FrameReader::arrival(const Frame& frame, const Known& known) const {
    FrameFlow::Arrival arrival;
    if (known.sent_ns != 0) {
        const std::int64_t now = proto::monotonic_ns();
        arrival.publish_index = frame.publish_index;
        arrival.captured_ns = known.captured_ns;
        arrival.sent_ns = known.sent_ns;
        arrival.now_ns = connection_.clock().latest(now);
        arrival.unwatched_ns = now - known.empty_ns;
        arrival.round_trip_ns = connection_.clock().round_trip();
    }
    return arrival;
}

/// Returns whether the frame may be given. One of a daemon that does not say when it was sent is the newest there is.
bool FrameReader::is_fresh(const Frame& frame) {
    return known_.sent_ns == 0 || flow_.fresh(arrival(frame, known_));
}

ReadResult FrameReader::give(Frame& frame) {
    give_credit(false);
    frame.skipped = skipped_.seen(frame.publish_index);
    frame.sent_age_ns = known_.age_ns;
    const std::int64_t now = proto::monotonic_ns();
    frame.age_ns = known_.sent_ns == 0 ? known_.age_ns + (now - known_.came_ns)
                                       : connection_.clock().latest(now) - known_.captured_ns;
    flow_.given(now);
    return ReadResult::frame;
}

void FrameReader::give_credit(bool waiting) {
    if (connection_.by_credit() && wants_frames_) {
        connection_.give_credit(flow_.ask(waiting));
    }
}

void FrameReader::keep() {
    Frame frame;
    known_ = take(frame);
    kept_ = std::move(frame);
}

}  // namespace disparity
