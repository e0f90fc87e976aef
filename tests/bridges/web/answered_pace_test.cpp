// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/live/answered_pace.h"

#include <gtest/gtest.h>

namespace disparityd::web {
namespace {

using namespace std::chrono_literals;

constexpr AnsweredPace::Time first_sent{1000h};

TEST(AnsweredPaceTest, OneIsUnderWayUntilItIsAnswered) {
    AnsweredPace pace('f');
    EXPECT_TRUE(pace.ready(first_sent));
    const std::string mark = pace.sent(first_sent);
    EXPECT_FALSE(pace.ready(first_sent + 1s));
    EXPECT_TRUE(pace.answered(mark, first_sent + 1s));
    EXPECT_TRUE(pace.ready(first_sent + 1s));
    EXPECT_FALSE(pace.answered(mark, first_sent + 1s)) << "it has been answered";
}

TEST(AnsweredPaceTest, TwoAreWhereAnswersAreQuickAndOneAgainWhereTheyAreNot) {
    AnsweredPace pace('f');
    pace.answered(pace.sent(first_sent), first_sent + 50ms);
    pace.sent(first_sent + 60ms);
    EXPECT_TRUE(pace.ready(first_sent + 90ms));
    const std::string last = pace.sent(first_sent + 90ms);
    EXPECT_FALSE(pace.ready(first_sent + 6s)) << "a viewer that pauses now has two to read";
    EXPECT_TRUE(pace.answered(last, first_sent + 6s));
    EXPECT_TRUE(pace.ready(first_sent + 6s)) << "the one before it has been read, too";
    pace.sent(first_sent + 6s);
    EXPECT_FALSE(pace.ready(first_sent + 1h));
}

TEST(AnsweredPaceTest, APeerThatNeverAnswersGetsFew) {
    AnsweredPace pace('f');
    for (auto now = first_sent; now < first_sent + 10s; now += 2s) {
        EXPECT_TRUE(pace.ready(now));
        pace.sent(now);
        EXPECT_FALSE(pace.ready(now + 1999ms));
    }
}

TEST(AnsweredPaceTest, OthersMarksAreNotItsOwn) {
    AnsweredPace frames('f');
    AnsweredPace samples('s');
    frames.sent(first_sent);
    EXPECT_FALSE(frames.answered(samples.sent(first_sent), first_sent));
    for (const char* mark : {"", "f", "f1", "0", "f00"}) {
        EXPECT_FALSE(frames.answered(mark, first_sent)) << mark;
    }
    EXPECT_FALSE(frames.ready(first_sent));
}

}  // namespace
}  // namespace disparityd::web
