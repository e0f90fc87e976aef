// SPDX-License-Identifier: Apache-2.0
#include "bridges/program/notes.h"

#include <vector>

#include <gtest/gtest.h>

namespace disparityd::bridges {
namespace {

using Lines = std::vector<std::string>;
using std::chrono::milliseconds;
using std::chrono::seconds;

class NotesTest : public ::testing::Test {
protected:
    Lines lines_;
    Notes notes_{[this](const std::string& line) { lines_.push_back(line); }};
    const Notes::Clock::time_point start_{seconds(1000)};

    void say(const std::string& line, milliseconds at, Notes::Repeat repeat = Notes::Repeat::every_minute) {
        notes_.say("topic", line, repeat, start_ + at);
    }
};

TEST_F(NotesTest, ALineIsRepeatedOnceAMinute) {
    for (int second = 0; second <= 120; ++second) {
        say("gone", seconds(second));
    }
    EXPECT_EQ(lines_, (Lines{"gone", "gone", "gone"}));
}

TEST_F(NotesTest, OrOnlyAfterAnother) {
    const auto never = Notes::Repeat::never;
    say("well", seconds(0), never);
    say("well", seconds(100), never);
    say("gone", seconds(200));
    say("well", seconds(300), never);
    EXPECT_EQ(lines_, (Lines{"well", "gone", "well"}));
}

TEST_F(NotesTest, LinesThatAlternateComeOnceASecond) {
    for (int i = 0; i < 40; ++i) {
        say(i % 2 == 0 ? "a" : "b", milliseconds(100 * i));
    }
    EXPECT_EQ(lines_.size(), 4U);
}

TEST_F(NotesTest, ALineOfOtherNumbersIsTheSame) {
    for (int second = 0; second <= 60; ++second) {
        say("gone for " + std::to_string(second) + " s", seconds(second));
    }
    EXPECT_EQ(lines_, (Lines{"gone for 0 s", "gone for 60 s"}));
}

TEST_F(NotesTest, TopicsAreApart) {
    say("a", seconds(0));
    notes_.say("other", "b", Notes::Repeat::never, start_);
    EXPECT_EQ(lines_, (Lines{"a", "b"}));
}

}  // namespace
}  // namespace disparityd::bridges
