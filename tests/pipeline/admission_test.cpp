// SPDX-License-Identifier: Apache-2.0
#include "pipeline/admission.h"

#include <thread>

#include <gtest/gtest.h>

namespace disparityd::pipeline {
namespace {

using namespace std::chrono_literals;
using Time = Admission::Time;

/// Stages of a frame: rectify and census 2 ms each, match 20, post-process 4, publish 1.
constexpr std::chrono::milliseconds times[] = {2ms, 2ms, 20ms, 4ms, 1ms};
constexpr std::size_t stages = 5;
constexpr std::size_t match = 2;

/// A pipeline by a clock of its own.
class AdmissionTest : public testing::Test {
protected:
    /// Frames of before, one after the other, of which the times are known.
    void pass(Admission& admission, int frames = 3) {
        for (int i = 0; i < frames; ++i) {
            for (std::size_t stage = 0; stage < stages; ++stage) {
                admission.begins(stage, now_);
                now_ += times[stage];
                admission.ends(stage, now_);
            }
        }
    }

    /// The frame that is in flight passes the stages before this one and begins it.
    void begin_at(Admission& admission, std::size_t stage) {
        for (std::size_t before = 0; before < stage; ++before) {
            admission.begins(before, now_);
            admission.ends(before, now_ += times[before]);
        }
        admission.begins(stage, now_);
    }

    Time now_{1h};
};

TEST_F(AdmissionTest, TheFirstFrameBeginsAtOnce) {
    for (const int workers : {1, 4}) {
        EXPECT_EQ(Admission(stages, 4, 4, workers).opens(now_), now_);
    }
}

TEST_F(AdmissionTest, OneWorkerHasOneFrame) {
    Admission admission(stages, 4, 4, 1);
    pass(admission);
    for (std::size_t stage = 0; stage < 4; ++stage) {
        admission.begins(stage, now_);
        EXPECT_FALSE(admission.opens(now_)) << stage;
        EXPECT_FALSE(admission.opens(now_ + 10s)) << "a stage that takes longer than before is not over";
        admission.ends(stage, now_);
    }
    EXPECT_EQ(admission.opens(now_), now_) << "what publishes it needs no worker";
    admission.begins(4, now_);
    EXPECT_EQ(admission.opens(now_), now_);
    Admission with_filter(stages, stages, 4, 1);
    begin_at(with_filter, 4);
    EXPECT_FALSE(with_filter.opens(now_)) << "a stage after matching computes in the last thread";
    with_filter.ends(4, now_);
    EXPECT_EQ(with_filter.opens(now_), now_);
}

TEST_F(AdmissionTest, TheNextFrameReachesTheSlowestStageWhenThatIsFree) {
    Admission admission(stages, 4, 4, 2);
    pass(admission);
    EXPECT_EQ(admission.opens(now_), now_);
    begin_at(admission, match);
    EXPECT_EQ(admission.opens(now_), now_ + 20ms - 4ms);
    EXPECT_EQ(admission.opens(now_ + 17ms), now_ + 17ms);
    // One that waits in front of it is counted, too.
    Admission two(stages, 4, 4, 2);
    pass(two);
    begin_at(two, match);
    for (std::size_t stage = 0; stage < match; ++stage) {
        two.begins(stage, now_);
        two.ends(stage, now_ += times[stage]);
    }
    EXPECT_EQ(two.opens(now_), now_ + 16ms + 20ms - 4ms) << "4 of the 20 ms have passed";
}

TEST_F(AdmissionTest, AStageThatIsLateIsAboutToEnd) {
    Admission admission(stages, 4, 4, 2);
    pass(admission);
    begin_at(admission, match);
    EXPECT_EQ(admission.opens(now_ + 50ms), now_ + 50ms);
}

TEST_F(AdmissionTest, TheTimeOfAStageCountsFromWhenItGotAWorker) {
    Admission admission(stages, 4, 4, 2);
    pass(admission);
    begin_at(admission, match);
    admission.begins(match, now_ += 30ms);
    EXPECT_EQ(admission.opens(now_), now_ + 20ms - 4ms);
}

TEST_F(AdmissionTest, TimesFollowTheFrames) {
    Admission admission(stages, 4, 4, 2);
    pass(admission);
    for (int frame = 0; frame < 60; ++frame) {
        begin_at(admission, match);
        admission.ends(match, now_ += 50ms);
        for (const std::size_t stage : {3U, 4U}) {
            admission.begins(stage, now_);
            admission.ends(stage, now_ += times[stage]);
        }
    }
    begin_at(admission, match);
    const auto opens = *admission.opens(now_) - now_;
    EXPECT_GT(opens, 45ms);
    EXPECT_LE(opens, 46ms);
}

TEST_F(AdmissionTest, WhoWaitsIsWoken) {
    Admission admission(stages, 4, 4, 1);
    admission.begins(0, std::chrono::steady_clock::now());
    Heartbeat heartbeat;
    std::thread waits([&] { admission.wait(heartbeat); });
    for (std::size_t stage = 0; stage < 4; ++stage) {
        admission.begins(stage, std::chrono::steady_clock::now());
        admission.ends(stage, std::chrono::steady_clock::now());
    }
    waits.join();
}

}  // namespace
}  // namespace disparityd::pipeline
