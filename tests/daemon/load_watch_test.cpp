// SPDX-License-Identifier: Apache-2.0
#include "daemon/load_watch.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace disparityd::daemon {
namespace {

using namespace std::chrono_literals;

/// Frames of 60/s that come to a daemon which matches some of them.
struct Load {
    std::string pass(std::chrono::seconds time, double matched_rate, double over_budget_rate = 0) {
        std::string told;
        for (auto passed = 0s; passed < time; passed += 1s) {
            now += 1s;
            came += 60;
            matched += matched_rate;
            over_budget += over_budget_rate;
            told +=
                watch.check(came, static_cast<std::uint64_t>(matched), static_cast<std::uint64_t>(over_budget), now);
        }
        return told;
    }

    LoadWatch watch{1280, 720, 128, 1.5};
    LoadWatch::Time now{1h};
    std::uint64_t came = 0;
    double matched = 0;
    double over_budget = 0;
};

TEST(LoadWatch, SaysOnceWhatWouldFit) {
    Load load;
    EXPECT_EQ(load.pass(30s, 32), "");
    EXPECT_EQ(load.pass(1s, 32),
              "matching is slower than the source: 60.0 frames/s come, 32.0 are matched, the others are dropped: about "
              "[match] disparities = 48 would fit, or [rectify] width = 880 and height = 496");
    EXPECT_EQ(load.pass(100s, 32), "");
}

TEST(LoadWatch, ABudgetThatIsTooSmallIsNamed) {
    Load load;
    load.pass(30s, 32, 27);
    EXPECT_EQ(
        load.pass(1s, 32, 27),
        "[pipeline] cores = 1.5 is less than matching needs: 60.0 frames/s come, 32.0 are matched, the others are "
        "left out: about [match] disparities = 48 would fit, or [rectify] width = 880 and height = 496");
}

TEST(LoadWatch, ABudgetThatLeavesNothingIsTold) {
    for (const double matched_rate : {0.0, 0.5}) {
        Load load;
        EXPECT_EQ(load.pass(30s, matched_rate, 59), "");
        const std::string told = load.pass(1s, matched_rate, 59);
        EXPECT_EQ(told.find(fmt::format("[pipeline] cores = 1.5 leaves hardly any time for matching: 60.0 frames/s "
                                        "come, {:.1f} are matched, the others are left out: the rest of the daemon",
                                        matched_rate)),
                  0U)
            << told;
        EXPECT_EQ(told.find("would fit"), std::string::npos) << "the frames may not be the reason";
        EXPECT_EQ(load.pass(100s, matched_rate, 59), "");
    }
}

TEST(LoadWatch, AFrameThatTheBudgetCostsNowAndThenIsNotTheReason) {
    Load load;
    load.pass(30s, 32, 5);
    EXPECT_EQ(load.pass(1s, 32, 5).find("matching is slower"), 0U);
}

TEST(LoadWatch, AShortTroubleIsNoMatter) {
    Load load;
    EXPECT_EQ(load.pass(30s, 60), "");
    EXPECT_EQ(load.pass(9s, 10), "");
    EXPECT_EQ(load.pass(60s, 58), "");
}

TEST(LoadWatch, NothingIsSaidOfASourceThatStandsStill) {
    Load load;
    EXPECT_EQ(load.pass(60s, 0), "") << "its frames are not matched at all: something else is wrong";
}

TEST(LoadWatch, WhereNoNumberOfDisparitiesFitsTheSizeIsNamed) {
    LoadWatch watch(672, 376, 16);
    std::string told;
    for (int second = 0; second < 40; ++second) {
        told += watch.check(static_cast<std::uint64_t>(100 * second), static_cast<std::uint64_t>(20 * second), 0,
                            LoadWatch::Time(1s * second));
    }
    EXPECT_EQ(
        told,
        "matching is slower than the source: 100.0 frames/s come, 20.0 are matched, the others are dropped: about "
        "[rectify] width = 280 and height = 152 would fit");
}

}  // namespace
}  // namespace disparityd::daemon
