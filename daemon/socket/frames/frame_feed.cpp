// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/frames/frame_feed.h"

#include <algorithm>
#include <utility>

namespace disparityd::daemon {

void FrameFeed::start(const FrameRing& ring, double max_rate, Order order) {
    order_ = order;
    max_rate_ = max_rate;
    next_due_ = {};
    next_index_ = ring.end();
    has_sent_ = false;
}

FrameHandle FrameFeed::take(const FrameRing& ring, std::uint32_t products) {
    FrameHandle taken;
    while (FrameHandle frame = ring.next(next_index_)) {
        next_index_ = frame->info.publish_index + 1;
        if ((frame->products & products) == products && is_due(frame->published)) {
            taken = std::move(frame);
            if (order_ == Order::oldest_first) {
                break;
            }
        }
    }
    if (taken && max_rate_ != 0) {
        count_due(taken->published);
    }
    return taken;
}

FrameFeed::Time::duration FrameFeed::interval() const {
    return std::chrono::duration_cast<Time::duration>(std::chrono::duration<double>(1.0 / std::max(max_rate_, 1e-6)));
}

/// A frame may be a little early: a source that jitters around the rate would lose every second frame otherwise.
bool FrameFeed::is_due(Time published) const {
    return max_rate_ == 0 || published + interval() / 20 >= next_due_;
}

/// Sets the next due time behind a frame of this one.
void FrameFeed::count_due(Time published) {
    const bool late = published > next_due_ + interval();
    next_due_ = (late ? published : next_due_) + interval();
}

std::uint64_t FrameFeed::count_sent(std::uint64_t publish_index) {
    const std::uint64_t skipped = has_sent_ ? publish_index - last_sent_ - 1 : 0;
    has_sent_ = true;
    last_sent_ = publish_index;
    frames_skipped_ += skipped;
    ++frames_sent_;
    return skipped;
}

}  // namespace disparityd::daemon
