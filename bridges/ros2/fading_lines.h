// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "bridges/program/notes.h"

namespace disparityd::ros2 {

/// Hands lines on ever more seldom while they keep coming: what others can cause without end must not fill the journal.
class FadingLines {
public:
    using Clock = std::chrono::steady_clock;

    explicit FadingLines(bridges::Notes::Write write) : write_(std::move(write)) {}

    /// Hands the line on, and how many were left out before it, unless the pause since the last one is not over. The
    /// pause is a second at first and twice as long after each line, an hour at most; after an hour without any line
    /// it is a second again.
    void say(const std::string& line, Clock::time_point now);

private:
    bridges::Notes::Write write_;
    Clock::time_point due_{};
    Clock::time_point last_{};
    Clock::duration pause_{};  ///< 0: no line yet
    std::uint64_t left_out_ = 0;
};

}  // namespace disparityd::ros2
