// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/pair_timing.h"

#include <algorithm>
#include <cstdlib>

namespace disparityd::capture {

namespace {

/// Cameras that get warm change their rates: a drift is not measured over longer than this.
constexpr std::int64_t longest_ns = 60'000'000'000;

/// A median of fewer is none.
constexpr std::size_t fewest = 3;

}  // namespace

bool PairTiming::add(std::int64_t left_ns, std::int64_t right_ns) {
    if (count_ == 0 || left_ns < begun_ns_) {
        begun_ns_ = left_ns;
        count_ = 0;
    }
    apart_[count_++] = right_ns - left_ns;
    const bool over = count_ == apart_.size() || left_ns - begun_ns_ >= window_ns;
    if (!over || count_ < fewest) {
        return false;
    }
    const auto middle = apart_.begin() + static_cast<std::ptrdiff_t>(count_ / 2);
    std::nth_element(apart_.begin(), middle, apart_.begin() + static_cast<std::ptrdiff_t>(count_));
    count_ = 0;
    end_window({begun_ns_ + (left_ns - begun_ns_) / 2, *middle});
    return newest_.has_value();
}

void PairTiming::end_window(const Window& window) {
    // Frames that drift change their partners, and what they are apart by jumps.
    const bool follows = last_ && std::abs(window.median_ns - last_->median_ns) < interval_ns_ / 4;
    if (!follows) {
        anchor_ = window;
    }
    if (last_) {
        newest_ = EyesApart{window.median_ns, newest_ ? newest_->drift : 0};
    }
    if (follows && window.centre_ns > anchor_->centre_ns) {
        newest_->drift = static_cast<double>(window.median_ns - anchor_->median_ns) /
                         static_cast<double>(window.centre_ns - anchor_->centre_ns);
    }
    if (window.centre_ns - anchor_->centre_ns > longest_ns) {
        anchor_ = window;
    }
    last_ = window;
    judge(window);
}

void PairTiming::judge(const Window& window) {
    const std::int64_t share = synchronised_ == Synchronised::no ? 20 : 10;
    if (std::abs(window.median_ns) * share > interval_ns_) {
        synchronised_ = Synchronised::no;
        near_.reset();
        return;
    }
    if (!near_) {
        near_ = window;
    }
    const std::int64_t time = window.centre_ns - near_->centre_ns;
    if (time < evidence_ns) {
        return;
    }
    const auto moved = static_cast<double>(std::abs(window.median_ns - near_->median_ns));
    if (moved < most_drift * static_cast<double>(time)) {
        synchronised_ = Synchronised::yes;
    } else if (synchronised_ == Synchronised::yes) {
        synchronised_ = Synchronised::unknown;
    }
    near_ = window;
}

void PairTiming::restart() {
    count_ = 0;
    anchor_.reset();
    last_.reset();
    newest_.reset();
    near_.reset();
    synchronised_ = Synchronised::unknown;
}

}  // namespace disparityd::capture
