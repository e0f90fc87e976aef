// SPDX-License-Identifier: Apache-2.0
#include "daemon/frame_cost.h"

#include <gmock/gmock.h>

namespace disparityd::daemon {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using Seconds = FrameCost::Seconds;

/// 20 ms of processor time for each frame that is matched, 4 ms for each that comes.
FrameCost cost_of_source() {
    return {.of_source = true, .passes = Seconds(0.010), .used = Seconds(0.020), .taken = Seconds(0.004)};
}

FrameLoad vga(double rate, double budget, bool leaves_out = true) {
    return {.rate = rate, .leaves_out = leaves_out, .budget = budget, .width = 672, .height = 376, .disparities = 64};
}

TEST(FrameCost, FramesThatAreLeftOutAreReadAllTheSame) {
    EXPECT_DOUBLE_EQ(most_in_budget(cost_of_source(), vga(15, 0.16)), (0.16 - 15 * 0.004) / 0.020);
    EXPECT_EQ(most_in_budget(cost_of_source(), vga(50, 0.16)), 0) << "reading alone takes more";
    EXPECT_DOUBLE_EQ(most_in_budget(cost_of_source(), vga(15, 0.12, false)), 0.12 / 0.024) << "a replay reads no more";
    FrameCost of_camera = cost_of_source();
    of_camera.taken.reset();
    EXPECT_DOUBLE_EQ(most_in_budget(of_camera, vga(15, 0.16)), 0.16 / 0.020);
}

TEST(FrameCost, TheBudgetIsToldWithWhatCounts) {
    EXPECT_EQ(cost_text(cost_of_source(), vga(15, 0.16)),
              "[pipeline] cores = 0.16 is less than matching needs: 15.0 frames/s come, at most 5.0 are matched, the "
              "others are left out: about [match] disparities = 16 would fit, or [rectify] width = 368 and height = "
              "200; a frame takes 20.0 ms of processor time from rectification to publication and 4.0 ms to be read; "
              "clients, recordings and self-calibration come on top");
    EXPECT_THAT(cost_text(cost_of_source(), vga(15, 1)),
                StartsWith("[pipeline] cores = 1 allows at most 47.0 frames/s, 15.0 come: a frame takes 20.0 ms"));
    EXPECT_THAT(cost_text(cost_of_source(), vga(30, 0.125)),
                AllOf(StartsWith("[pipeline] cores = 0.125 leaves hardly any time"), HasSubstr("at most 0.3 are")));
    FrameCost of_camera = cost_of_source();
    of_camera.of_source = false;
    of_camera.taken.reset();
    EXPECT_THAT(cost_text(of_camera, vga(15, 0.16)),
                HasSubstr("; its capture, clients, recordings and self-calibration come on top"));
}

TEST(FrameCost, TheTimeOfAReplayIsNotThatOfItsBudget) {
    EXPECT_THAT(cost_text(cost_of_source(), vga(15, 0.12, false)),
                AllOf(StartsWith("[pipeline] cores = 0.12 lets at most 5.0 frames/s pass: a frame takes 20.0 ms"),
                      Not(HasSubstr("left out"))));
    EXPECT_EQ(cost_text(cost_of_source(), vga(15, 0, false)), "computing takes 10.0 ms a frame of the source here");
}

TEST(FrameCost, WhatIsSlowerDecides) {
    EXPECT_THAT(cost_text(cost_of_source(), vga(200, 0)),
                StartsWith("matching is slower than the source: 200.0 frames/s come, 100.0 are matched"));
    EXPECT_THAT(cost_text(cost_of_source(), vga(200, 256)), StartsWith("matching is slower than the source: "));
    EXPECT_THAT(cost_text(cost_of_source(), vga(150, 1)),
                StartsWith("[pipeline] cores = 1 is less than matching needs: 150.0 frames/s come, at most 20.0 are"));
    EXPECT_EQ(cost_text({.passes = Seconds(0.010), .used = Seconds(0.020)}, vga(15, 0)),
              "computing takes 10.0 ms a frame of noise here");
    EXPECT_EQ(cost_text({.passes = Seconds(0.010), .used = Seconds(0.020), .unread = "a.mkv: damaged"}, vga(15, 0)),
              "no frame of the source can be read: a.mkv: damaged; computing takes 10.0 ms a frame of noise here");
}

}  // namespace
}  // namespace disparityd::daemon
