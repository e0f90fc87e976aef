// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>

namespace disparityd::web {

/// Decides when a page gets its next frame, and how large. At most two frames are under way: sent, and not yet told to
/// be seen. So a slow link or a slow page gets fewer frames and always the newest one. Where frames take long although
/// they are few, they become smaller.
class FramePace {
public:
    using Time = std::chrono::steady_clock::time_point;

    /// Frames per second at most; 0 = all.
    void set_max_rate(double rate) {
        max_rate_ = rate;
        next_ = {};
    }

    /// Returns whether a frame may be sent now. When only the rate forbids it, next() says from when on it may.
    bool ready(Time now) const { return under_way_.size() < most_under_way && now >= next_; }
    bool held_by_rate(Time now) const { return under_way_.size() < most_under_way && now < next_; }
    Time next() const { return next_; }

    void sent(std::uint64_t publish_index, Time now);
    /// The page has drawn this frame, and so all before it.
    void seen(std::uint64_t publish_index, Time now);

    /// Forgets how long frames took: the next ones are made otherwise.
    void forget_way(Time now);

    /// Images are 1, 2 or 4 times smaller than asked.
    int scale() const { return scale_; }

private:
    static constexpr std::size_t most_under_way = 2;
    static constexpr std::chrono::seconds first_trial{4};
    struct Sent {
        std::uint64_t publish_index;
        Time time;
    };

    void adapt(std::chrono::nanoseconds way, Time now);

    double max_rate_ = 0;
    Time next_{};
    std::deque<Sent> under_way_;
    int scale_ = 1;
    std::optional<std::chrono::nanoseconds> usual_way_;  ///< from sending to being seen, smoothed
    Time scaled_at_{};
    std::chrono::seconds trial_ = first_trial;  ///< so long a scale is kept before a larger image is tried
};

}  // namespace disparityd::web
