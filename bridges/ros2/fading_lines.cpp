// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros2/fading_lines.h"

#include <algorithm>

namespace disparityd::ros2 {
namespace {

constexpr FadingLines::Clock::duration shortest = std::chrono::seconds(1);
constexpr FadingLines::Clock::duration longest = std::chrono::hours(1);

}  // namespace

void FadingLines::say(const std::string& line, Clock::time_point now) {
    const bool quiet = pause_ == Clock::duration() || now - last_ >= longest;
    last_ = now;
    if (!quiet && now < due_) {
        ++left_out_;
        return;
    }
    std::string told = line;
    if (left_out_ > 0) {
        told.append(" (").append(std::to_string(left_out_)).append(" others were left out before)");
    }
    write_(told);
    left_out_ = 0;
    pause_ = quiet ? shortest : std::min(2 * pause_, longest);
    due_ = now + pause_;
}

}  // namespace disparityd::ros2
