// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/live/frame_pace.h"

#include <algorithm>

namespace disparityd::web {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr milliseconds slow{300};   ///< a frame that takes longer from here to the eye feels late
constexpr milliseconds quick{100};  ///< from here on a larger image may be tried
constexpr int largest_scale = 4;
constexpr seconds longest_trial{64};

}  // namespace

void FramePace::sent(std::uint64_t publish_index, Time now) {
    under_way_.push_back({publish_index, now});
    if (max_rate_ > 0) {
        const auto interval =
            std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(1 / max_rate_));
        // A frame that came late does not make the ones after it late, and a pause does not make them many.
        next_ = std::max(next_ + interval, now + interval / 2);
    }
}

void FramePace::seen(std::uint64_t publish_index, Time now) {
    // Not by size: a daemon that was started again counts from 0.
    const auto found = std::find_if(under_way_.begin(), under_way_.end(),
                                    [&](const Sent& sent) { return sent.publish_index == publish_index; });
    if (found != under_way_.end()) {
        adapt(now - found->time, now);
        under_way_.erase(under_way_.begin(), found + 1);
    }
}

void FramePace::forget_way(Time now) {
    scale_ = 1;
    usual_way_.reset();
    scaled_at_ = now;  // those of before, which are still under way, scale nothing
    trial_ = first_trial;
}

void FramePace::adapt(std::chrono::nanoseconds way, Time now) {
    usual_way_ = usual_way_ ? (*usual_way_ * 3 + way) / 4 : way;
    if (*usual_way_ > slow && scale_ < largest_scale && now - scaled_at_ > seconds(1)) {
        // A larger image was tried too soon: the next trial comes later.
        trial_ = now - scaled_at_ < 2 * trial_ ? std::min(2 * trial_, longest_trial) : first_trial;
        scale_ *= 2;
        scaled_at_ = now;
        usual_way_.reset();
    } else if (*usual_way_ < quick && scale_ > 1 && now - scaled_at_ > trial_) {
        scale_ /= 2;
        scaled_at_ = now;
        usual_way_.reset();
    }
}

}  // namespace disparityd::web
