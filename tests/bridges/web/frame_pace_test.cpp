// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/live/frame_pace.h"

#include <gtest/gtest.h>

namespace disparityd::web {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class FramePaceTest : public ::testing::Test {
protected:
    /// Frames go out as fast as they are seen, and take this long from here to the eye.
    void run(milliseconds way, seconds time) {
        const auto end = now_ + time;
        while (now_ < end) {
            pace_.sent(++index_, now_);
            now_ += way;
            pace_.seen(index_, now_);
        }
    }

    FramePace pace_;
    FramePace::Time now_{seconds(1000)};
    std::uint64_t index_ = 0;
};

TEST_F(FramePaceTest, AtMostTwoFramesAreUnderWay) {
    EXPECT_TRUE(pace_.ready(now_));
    pace_.sent(1, now_);
    EXPECT_TRUE(pace_.ready(now_));
    pace_.sent(2, now_);
    EXPECT_FALSE(pace_.ready(now_ + seconds(100)));
    EXPECT_FALSE(pace_.held_by_rate(now_));
    pace_.seen(1, now_);
    EXPECT_TRUE(pace_.ready(now_));
}

TEST_F(FramePaceTest, ASeenFrameStandsForThoseBeforeIt) {
    pace_.sent(7, now_);
    pace_.sent(9, now_);
    pace_.seen(8, now_);  // was never sent
    EXPECT_FALSE(pace_.ready(now_));
    pace_.seen(9, now_);
    pace_.sent(10, now_);
    EXPECT_TRUE(pace_.ready(now_));
}

TEST_F(FramePaceTest, ADaemonThatCountsFromZeroAgainStopsNothing) {
    pace_.sent(1000, now_);
    pace_.sent(0, now_);
    EXPECT_FALSE(pace_.ready(now_));
    pace_.seen(0, now_);
    pace_.sent(1, now_);
    EXPECT_TRUE(pace_.ready(now_));
}

TEST_F(FramePaceTest, TheRateIsKept) {
    pace_.set_max_rate(10);
    int sent = 0;
    for (int i = 0; i < 1000; ++i, now_ += milliseconds(5)) {  // 200 frames per second for 5 s
        if (pace_.ready(now_)) {
            pace_.sent(++index_, now_);
            pace_.seen(index_, now_);
            ++sent;
        } else {
            EXPECT_TRUE(pace_.held_by_rate(now_));
            EXPECT_GT(pace_.next(), now_);
        }
    }
    EXPECT_NEAR(sent, 50, 1);
}

TEST_F(FramePaceTest, AnotherRateHoldsAtOnce) {
    pace_.set_max_rate(0.01);
    pace_.sent(1, now_);
    pace_.seen(1, now_);
    EXPECT_FALSE(pace_.ready(now_ + seconds(10)));
    pace_.set_max_rate(0);
    EXPECT_TRUE(pace_.ready(now_));
}

TEST_F(FramePaceTest, ASlowLinkGetsSmallerFramesDownToAQuarter) {
    run(milliseconds(400), seconds(1));
    EXPECT_EQ(pace_.scale(), 2);
    run(milliseconds(400), seconds(30));
    EXPECT_EQ(pace_.scale(), 4);
}

TEST_F(FramePaceTest, AQuickLinkKeepsTheSize) {
    run(milliseconds(30), seconds(60));
    EXPECT_EQ(pace_.scale(), 1);
    run(milliseconds(200), seconds(60));
    EXPECT_EQ(pace_.scale(), 1);
}

TEST_F(FramePaceTest, FramesThatAreMadeOtherwiseBeginWithTheWholeSize) {
    run(milliseconds(400), seconds(10));
    pace_.forget_way(now_);
    EXPECT_EQ(pace_.scale(), 1);
    run(milliseconds(400), seconds(10));
    EXPECT_EQ(pace_.scale(), 4);
}

TEST_F(FramePaceTest, ALinkThatRecoversGetsTheWholeSizeBack) {
    run(milliseconds(400), seconds(10));
    EXPECT_EQ(pace_.scale(), 4);
    run(milliseconds(20), seconds(200));
    EXPECT_EQ(pace_.scale(), 1);
}

TEST_F(FramePaceTest, TrialsOfALargerSizeBecomeRare) {
    // Whole images take too long, smaller ones do not: each trial ends in a late second.
    int changes = 0;
    int last = 1;
    const auto end = now_ + seconds(300);
    while (now_ < end) {
        pace_.sent(++index_, now_);
        now_ += pace_.scale() == 1 ? milliseconds(500) : milliseconds(50);
        pace_.seen(index_, now_);
        changes += pace_.scale() != last ? 1 : 0;
        last = pace_.scale();
    }
    EXPECT_LE(changes, 20);
    EXPECT_GE(changes, 3);
}

}  // namespace
}  // namespace disparityd::web
