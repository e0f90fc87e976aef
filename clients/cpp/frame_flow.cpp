// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/frame_flow.h"

#include <algorithm>
#include <cmath>

namespace disparity {
namespace {

constexpr std::int64_t millisecond = 1'000'000;

/// More the daemon does not keep.
constexpr std::uint32_t most_ahead = 16;

/// A program that waits looks at the socket at least this often; with some time for a machine that is busy.
constexpr std::int64_t watched_ns = 100 * millisecond;

/// A frame may have lain for so long where the interval is shorter, which a busy machine takes now and then, or is not
/// known.
constexpr std::int64_t least_allowed_ns = 20 * millisecond;
constexpr std::int64_t unknown_interval_ns = 500 * millisecond;

/// A daemon may send any times: of longer intervals and ways no sum or product would fit.
constexpr std::int64_t longest_ns = 1'000'000'000 * millisecond;

/// An interval that is this many times the one before is a gap of the source, and changes the estimate by no more.
constexpr std::int64_t most_growth = 2;

}  // namespace

void FrameFlow::start(double max_rate) {
    *this = {};
    least_interval_ns_ = max_rate > 0 ? static_cast<std::int64_t>(std::min(1e9 / max_rate, 1.0 * longest_ns)) : 0;
}

void FrameFlow::reads(std::int64_t now_ns) {
    waited_ = false;
    if (working_) {
        work_ns_ = now_ns - given_ns_;
        working_ = false;
    }
}

void FrameFlow::given(std::int64_t now_ns) {
    given_ns_ = now_ns;
    working_ = true;
}

std::int64_t FrameFlow::interval_ns() const {
    return std::max(published_ns_, least_interval_ns_);
}

std::int64_t FrameFlow::patience_ns() const {
    return std::clamp(3 * std::max(way_ns_, round_trip_ns_), 5 * millisecond, 200 * millisecond);
}

/// Returns how many frames may be on order. The program orders when it begins to wait, as many as come before it waits
/// again: an order that was sent while a frame is given would make that frame late. Where the link itself is what
/// limits the rate, more frames would only wait on it for each other.
std::uint32_t FrameFlow::wanted(bool waiting) const {
    const std::int64_t interval = interval_ns();
    if (interval == 0 || way_ns_ < 0) {
        return 1;
    }
    if (work_ns_ > interval) {
        return waiting ? 1 : 0;
    }
    const auto round_trip = static_cast<double>(round_trip_ns_);
    const double transfer = std::max(0.0, static_cast<double>(way_ns_) - round_trip / 2);
    const auto every = static_cast<double>(interval);
    const auto until_next_wait = static_cast<double>(waited_ ? work_ns_ : interval);
    const double needed = transfer >= 0.9 * every
                              ? 1 + std::floor(round_trip / transfer)
                              : std::ceil((transfer + round_trip + until_next_wait) / every + 0.25) - (waiting ? 0 : 1);
    return static_cast<std::uint32_t>(std::clamp(needed, 0.0, double{most_ahead}));
}

std::uint32_t FrameFlow::ask(bool waiting) {
    waited_ = waited_ || waiting;
    const std::uint32_t frames = wanted(waiting);
    const std::uint32_t more = frames > on_the_way_ ? frames - on_the_way_ : 0;
    on_the_way_ += more;
    return more;
}

void FrameFlow::arrived(const Arrival& frame) {
    on_the_way_ -= on_the_way_ > 0 ? 1 : 0;
    round_trip_ns_ = frame.round_trip_ns;
    if (any_ && frame.publish_index > last_index_ && frame.captured_ns > last_captured_ns_) {
        const auto time = static_cast<std::uint64_t>(frame.captured_ns - last_captured_ns_);
        const auto every = static_cast<std::int64_t>(time / (frame.publish_index - last_index_));
        const std::int64_t interval = std::min(every, longest_ns);
        published_ns_ = published_ns_ == 0
                            ? interval
                            : published_ns_ + (std::min(interval, most_growth * published_ns_) - published_ns_) / 4;
    }
    any_ = true;
    last_index_ = frame.publish_index;
    last_captured_ns_ = frame.captured_ns;
}

bool FrameFlow::fresh(const Arrival& frame) {
    const std::int64_t way = std::clamp<std::int64_t>(frame.now_ns - frame.sent_ns, 0, longest_ns);
    const bool suspect = suspects_ > 0;
    suspects_ -= suspect ? 1 : 0;
    const std::int64_t allowed = interval_ns() == 0 ? unknown_interval_ns : std::max(interval_ns(), least_allowed_ns);
    if (way_ns_ >= 0 && way - way_ns_ <= allowed) {
        // The measure falls at once and rises slowly: a frame that waited is not its measure.
        way_ns_ = way < way_ns_ ? way : way_ns_ + (way - way_ns_) / 16;
        refused_ = false;
        return true;
    }
    if ((way_ns_ < 0 || refused_) && !suspect && frame.unwatched_ns <= watched_ns) {
        way_ns_ = way;  // the first frame, or the link has become slower
        refused_ = false;
        return true;
    }
    refused_ = true;
    suspects_ = on_the_way_;
    return false;
}

}  // namespace disparity
