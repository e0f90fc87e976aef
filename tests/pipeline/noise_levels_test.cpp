// SPDX-License-Identifier: Apache-2.0
#include "pipeline/noise_levels.h"

#include <algorithm>
#include <deque>
#include <future>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace disparityd::pipeline {
namespace {

/// A pair whose eyes differ by +- `amplitude` grey levels, which is a noise of amplitude / sqrt(2) in each.
class NoisyFrame {
public:
    explicit NoisyFrame(int amplitude)
        : left_(side * side, 100), right_(side * side), disparity_(side * side, 0), confidence_(side * side, 200) {
        for (std::size_t i = 0; i < right_.size(); ++i) {
            right_[i] = static_cast<std::uint8_t>(100 + (i % 2 == 0 ? amplitude : -amplitude));
        }
        view_.left = {left_.data(), side, side, side};
        view_.right = {right_.data(), side, side, side};
        view_.disparity = {disparity_.data(), side, side, side};
        view_.confidence = {confidence_.data(), side, side, side};
    }

    const FrameView& view() const { return view_; }

private:
    static constexpr int side = 64;
    std::vector<std::uint8_t> left_;
    std::vector<std::uint8_t> right_;
    std::vector<std::int16_t> disparity_;
    std::vector<std::uint8_t> confidence_;
    FrameView view_;
};

struct Captured {
    int amplitude = 0;
    bool discontinuity = false;
};

/// Returns the level of each frame where `in_flight` of them are begun before the first one is finished.
std::vector<int> levels_of(const std::vector<Captured>& frames, std::size_t in_flight) {
    NoiseLevels levels;
    Heartbeat heartbeat;
    const std::atomic<bool> failed{false};
    Serial serial;
    std::vector<int> found;
    std::size_t finished = 0;
    const auto finish = [&] {
        const NoisyFrame frame(frames[finished].amplitude);
        levels.run({.view = frame.view(), .memory = {}, .discontinuity = frames[finished].discontinuity, .up = {}},
                   serial);
        ++finished;
    };
    for (const Captured& frame : frames) {
        if (found.size() - finished == in_flight) {
            finish();
        }
        found.push_back(levels.next(frame.discontinuity, heartbeat, failed));
    }
    return found;
}

TEST(NoiseLevels, FollowTheNoiseOfTheFourthFrameBefore) {
    std::vector<Captured> frames(6, {0});
    frames.resize(12, {6});
    EXPECT_THAT(levels_of(frames, 1), testing::ElementsAre(0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3, 3));
}

TEST(NoiseLevels, DoNotDependOnHowManyFramesAreInFlight) {
    std::vector<Captured> frames;
    for (int i = 0; i < 60; ++i) {
        frames.push_back({i % 17 < 3 ? 6 : i % 5, i == 23});
    }
    const std::vector<int> levels = levels_of(frames, 1);
    EXPECT_GT(*std::max_element(levels.begin(), levels.end()), 0);
    for (const std::size_t in_flight : {2U, 3U, 4U}) {
        EXPECT_EQ(levels_of(frames, in_flight), levels);
    }
}

TEST(NoiseLevels, BeginAnewWithTheSource) {
    std::vector<Captured> frames(8, {6});
    frames.push_back({0, true});
    frames.resize(16, {0});
    EXPECT_THAT(levels_of(frames, 4), testing::ElementsAre(0, 0, 0, 0, 3, 3, 3, 3, 0, 0, 0, 0, 0, 0, 0, 0));
}

TEST(NoiseLevels, AFrameTooManyWaitsForItsLevel) {
    NoiseLevels levels;
    Heartbeat heartbeat;
    const std::atomic<bool> failed{false};
    for (int i = 0; i < 4; ++i) {
        EXPECT_EQ(levels.next(false, heartbeat, failed), 0);
    }
    auto fifth = std::async(std::launch::async, [&] { return levels.next(false, heartbeat, failed); });
    EXPECT_EQ(fifth.wait_for(std::chrono::milliseconds(20)), std::future_status::timeout);
    Serial serial;
    const NoisyFrame frame(6);
    levels.run({.view = frame.view(), .memory = {}, .up = {}}, serial);
    EXPECT_EQ(fifth.get(), 3);
    ASSERT_TRUE(levels.newest());
    EXPECT_NEAR(levels.newest()->sigma256, 1086, 2);  // 6 / sqrt(2)
}

TEST(NoiseLevels, AFailureEndsTheWait) {
    NoiseLevels levels;
    Heartbeat heartbeat;
    std::atomic<bool> failed{false};
    for (int i = 0; i < 4; ++i) {
        levels.next(false, heartbeat, failed);
    }
    auto fifth = std::async(std::launch::async, [&] { return levels.next(false, heartbeat, failed); });
    failed = true;
    fifth.get();
}

}  // namespace
}  // namespace disparityd::pipeline
