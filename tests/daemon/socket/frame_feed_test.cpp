// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/frames/frame_feed.h"

#include <vector>

#include <gtest/gtest.h>

#include "tests/daemon/socket/pattern_frames.h"

namespace disparityd::test {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t disparity = daemon::product_bit(v1::DISPARITY);
constexpr std::uint32_t left = daemon::product_bit(v1::LEFT);

class FrameFeedTest : public testing::Test {
protected:
    static constexpr std::size_t capacity = 4;

    /// Puts one more frame into the ring, published so long after the first one.
    void publish(std::chrono::steady_clock::duration at = {}, std::uint32_t products = ~0U) {
        daemon::PublishedFrame frame = frames_.next();
        frame.published = first_ + at;
        ring_.put(pool_.copy(frame, products));
    }

    /// Publishes frames at intervals and takes those that are due after each; their publish indices.
    std::vector<std::uint64_t> take_each(int count, std::chrono::steady_clock::duration interval) {
        std::vector<std::uint64_t> taken;
        for (int i = 0; i < count; ++i) {
            publish(now_);
            now_ += interval;
            while (const auto frame = feed_.take(ring_, disparity)) {
                taken.push_back(frame->info.publish_index);
            }
        }
        return taken;
    }

    const std::chrono::steady_clock::time_point first_ = std::chrono::steady_clock::now();
    std::chrono::steady_clock::duration now_{0};
    PatternFrames frames_{8, 6, {v1::DISPARITY, v1::LEFT}};
    daemon::FramePool pool_{frames_.layout(), capacity + 3};
    daemon::FrameRing ring_{capacity};
    daemon::FrameFeed feed_;
};

TEST_F(FrameFeedTest, BeginsWithTheNextFrame) {
    publish();
    publish();
    feed_.start(ring_, 0);
    EXPECT_FALSE(feed_.has_next(ring_));
    EXPECT_EQ(feed_.take(ring_, disparity), nullptr);
    EXPECT_EQ(take_each(3, 10ms), (std::vector<std::uint64_t>{2, 3, 4}));
    EXPECT_FALSE(feed_.has_next(ring_));
}

TEST_F(FrameFeedTest, LeavesOutFramesWithoutAProduct) {
    feed_.start(ring_, 0);
    publish({}, disparity);
    publish({}, disparity | left);
    publish({}, left);
    const auto both = feed_.take(ring_, disparity | left);
    ASSERT_NE(both, nullptr);
    EXPECT_EQ(both->info.publish_index, 1U);
    EXPECT_EQ(feed_.take(ring_, disparity | left), nullptr);
    EXPECT_FALSE(feed_.has_next(ring_)) << "the last one was passed over";
}

TEST_F(FrameFeedTest, ASlowClientGoesOnWithTheOldestFrameInTheRing) {
    feed_.start(ring_, 0);
    publish();
    ASSERT_EQ(feed_.take(ring_, disparity)->info.publish_index, 0U);
    EXPECT_EQ(feed_.count_sent(0), 0U);
    for (int i = 0; i < 10; ++i) {
        publish();
    }
    const auto next = feed_.take(ring_, disparity);
    ASSERT_NE(next, nullptr);
    EXPECT_EQ(next->info.publish_index, 7U) << "of 7, 8, 9, 10";
    EXPECT_EQ(feed_.count_sent(7), 6U);
    EXPECT_EQ(feed_.count_sent(8), 0U);
    EXPECT_EQ(feed_.frames_sent(), 3U);
    EXPECT_EQ(feed_.frames_skipped(), 6U);
}

TEST_F(FrameFeedTest, WhatWasMissedBeforeTheFirstFrameIsNotSkipped) {
    feed_.start(ring_, 0);
    EXPECT_EQ(feed_.count_sent(20), 0U);
    EXPECT_EQ(feed_.count_sent(22), 1U);
    feed_.start(ring_, 0);
    EXPECT_EQ(feed_.count_sent(30), 0U) << "by another subscription";
    EXPECT_EQ(feed_.frames_sent(), 3U) << "totals go on";
    EXPECT_EQ(feed_.frames_skipped(), 1U);
}

TEST_F(FrameFeedTest, AtMostTheRateIsTaken) {
    feed_.start(ring_, 10);
    EXPECT_EQ(take_each(13, 25ms), (std::vector<std::uint64_t>{0, 4, 8, 12}));
}

// 4 % early: without the tolerance frames 1, 3 and 5 would be missing.
TEST_F(FrameFeedTest, AFrameALittleEarlyIsTaken) {
    feed_.start(ring_, 10);
    EXPECT_EQ(take_each(6, 99ms), (std::vector<std::uint64_t>{0, 1, 2, 3, 4, 5}));
}

TEST_F(FrameFeedTest, AfterAPauseTheRateBeginsAnew) {
    feed_.start(ring_, 10);
    EXPECT_EQ(take_each(5, 25ms), (std::vector<std::uint64_t>{0, 4}));
    now_ += 10s;
    EXPECT_EQ(take_each(5, 25ms), (std::vector<std::uint64_t>{5, 9})) << "nothing is made up for";
}

TEST_F(FrameFeedTest, NewestOnlyPassesOverTheOthers) {
    feed_.start(ring_, 0, daemon::FrameFeed::Order::newest_only);
    publish();
    publish();
    publish({}, left);
    EXPECT_FALSE(feed_.would_take(ring_, ring_.next(0)));
    EXPECT_TRUE(feed_.would_take(ring_, ring_.next(2))) << "its products are the caller's matter";
    const auto newest = feed_.take(ring_, disparity);
    ASSERT_NE(newest, nullptr);
    EXPECT_EQ(newest->info.publish_index, 1U) << "the newest that has the product";
    EXPECT_EQ(feed_.take(ring_, disparity), nullptr);
    EXPECT_FALSE(feed_.would_take(ring_, newest));
}

TEST_F(FrameFeedTest, NewestOnlyKeepsTheRate) {
    feed_.start(ring_, 10, daemon::FrameFeed::Order::newest_only);
    publish(0ms);
    publish(25ms);
    EXPECT_EQ(feed_.take(ring_, disparity)->info.publish_index, 1U) << "both are due";
    publish(50ms);
    EXPECT_EQ(feed_.take(ring_, disparity), nullptr) << "25 ms after the one before";
    publish(124ms);
    publish(126ms);
    EXPECT_EQ(feed_.take(ring_, disparity)->info.publish_index, 4U);
}

TEST_F(FrameFeedTest, KnowsWhichFrameItWouldTake) {
    feed_.start(ring_, 0);
    publish();
    publish();
    const auto first = ring_.next(0);
    const auto second = ring_.next(1);
    EXPECT_TRUE(feed_.would_take(ring_, first));
    EXPECT_FALSE(feed_.would_take(ring_, second));
    feed_.take(ring_, disparity);
    EXPECT_FALSE(feed_.would_take(ring_, first));
    EXPECT_TRUE(feed_.would_take(ring_, second));
    feed_.start(ring_, 5);
    publish();
    EXPECT_FALSE(feed_.would_take(ring_, ring_.next(2))) << "it would have to look at the times";
}

}  // namespace
}  // namespace disparityd::test
