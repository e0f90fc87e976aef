// SPDX-License-Identifier: Apache-2.0
#include "lab/reaction/reaction_times.h"

#include <algorithm>

namespace disparityd::reaction {

ReactionTimes::ReactionTimes(std::int64_t period_ns, int without, int with)
    : period_ns_(period_ns),
      without_(static_cast<std::uint64_t>(without)),
      frames_(static_cast<std::uint64_t>(without) + static_cast<std::uint64_t>(with)) {}

void ReactionTimes::add(const SeenFrame& frame) {
    const std::uint64_t round = frame.sequence / frames_;
    const std::uint64_t place = frame.sequence % frames_;
    if (rounds_begun_ == 0 || round != round_) {
        end_round();
        ++rounds_begun_;
        round_ = round;
        begun_ns_ = std::numeric_limits<std::int64_t>::max();
        shown_ = false;
        shown_before_ = false;
    }
    begun_ns_ = std::min(begun_ns_, frame.received_ns - frame.age_ns - static_cast<std::int64_t>(place) * period_ns_);
    if (place < without_) {
        shown_before_ = shown_before_ || frame.shown;
    } else if (frame.shown && !shown_) {
        shown_ = true;
        shown_ns_ = frame.received_ns;
    }
}

void ReactionTimes::end_round() {
    if (rounds_begun_ < 2) {
        return;
    }
    ++result_.appearances;
    result_.shown_before += shown_before_ ? 1 : 0;
    if (shown_) {
        result_.reactions_ns.push_back(shown_ns_ - begun_ns_ - static_cast<std::int64_t>(without_) * period_ns_);
    } else {
        ++result_.never_shown;
    }
}

}  // namespace disparityd::reaction
