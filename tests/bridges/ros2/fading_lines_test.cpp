// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros2/fading_lines.h"

#include <vector>

#include <gtest/gtest.h>

namespace disparityd::ros2 {
namespace {

using Lines = std::vector<std::string>;
using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;

class FadingLinesTest : public ::testing::Test {
protected:
    void say(const std::string& line, milliseconds at) { fading_.say(line, start_ + at); }

    Lines lines_;
    FadingLines fading_{[this](const std::string& line) { lines_.push_back(line); }};
    const FadingLines::Clock::time_point start_{seconds(1000)};
};

TEST_F(FadingLinesTest, WhatIsLeftOutIsCounted) {
    for (int i = 0; i < 35; ++i) {
        say(std::to_string(i), milliseconds(100 * i));
    }
    EXPECT_EQ(lines_, (Lines{"0", "10 (9 others were left out before)", "30 (19 others were left out before)"}));
}

TEST_F(FadingLinesTest, ADayOfOneASecondIsFewLines) {
    for (int i = 0; i < 24 * 3600; ++i) {
        say("malformed packet", seconds(i));
    }
    EXPECT_GE(lines_.size(), 24U) << "it does not fall silent";
    EXPECT_LE(lines_.size(), 12U + 24U);
}

TEST_F(FadingLinesTest, SingleLinesAreAllSaid) {
    for (int i = 0; i < 5; ++i) {
        say("packet", hours(i));
    }
    EXPECT_EQ(lines_, Lines(5, "packet"));
}

TEST_F(FadingLinesTest, AfterAQuietHourItBeginsAnew) {
    for (int i = 0; i < 10'000; ++i) {
        say("storm", seconds(i));
    }
    lines_.clear();
    say("calm", seconds(10'000) + hours(1));
    say("calm", seconds(10'002) + hours(1));
    ASSERT_EQ(lines_.size(), 2U);
    EXPECT_TRUE(lines_[0].starts_with("calm (")) << "what the storm left out is told";
    EXPECT_EQ(lines_[1], "calm");
}

}  // namespace
}  // namespace disparityd::ros2
