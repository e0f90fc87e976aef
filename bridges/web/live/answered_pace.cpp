// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/live/answered_pace.h"

#include <algorithm>

namespace disparityd::web {

std::string AnsweredPace::sent(Time now) {
    if (under_way_.size() >= most()) {
        under_way_.pop_front();
    }
    under_way_.push_back({name_ + std::to_string(next_++), now});
    return under_way_.back().mark;
}

bool AnsweredPace::answered(std::string_view mark, Time now) {
    constexpr std::chrono::milliseconds quick{100};
    const auto found =
        std::find_if(under_way_.begin(), under_way_.end(), [mark](const Sent& sent) { return sent.mark == mark; });
    if (found == under_way_.end()) {
        return false;
    }
    has_answered_ = true;
    quick_ = now - found->time <= quick;
    under_way_.erase(under_way_.begin(), found + 1);
    return true;
}

}  // namespace disparityd::web
