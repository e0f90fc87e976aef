// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/pair_timing.h"

#include <gtest/gtest.h>

namespace disparityd::capture {
namespace {

using Synchronised = PairTiming::Synchronised;

TEST(PairTiming, TellsMediansAndForgetsThemWithTheStream) {
    constexpr std::int64_t ms = 1'000'000;
    PairTiming timing(10 * ms);
    std::int64_t now = 0;
    const auto pairs = [&](int count, std::int64_t apart) {
        bool news = false;
        for (int i = 0; i < count; ++i) {
            now += 10 * ms;
            news = timing.add(now, now + (i % 10 == 0 ? 5 * ms : apart)) || news;  // one in ten is an outlier
        }
        return news;
    };
    EXPECT_FALSE(pairs(260, ms / 2)) << "one window is no drift";
    EXPECT_TRUE(pairs(260, ms / 2));
    EXPECT_EQ(timing.newest()->median_ns, ms / 2);
    EXPECT_EQ(timing.synchronised(), Synchronised::unknown);
    pairs(520, -2 * ms);
    EXPECT_EQ(timing.newest()->median_ns, -2 * ms);
    EXPECT_EQ(timing.synchronised(), Synchronised::no);
    pairs(31'000, -6 * ms / 10);
    EXPECT_EQ(timing.synchronised(), Synchronised::no) << "it stays until a twentieth";
    pairs(29'000, -4 * ms / 10);
    EXPECT_EQ(timing.synchronised(), Synchronised::no) << "it stays until there is evidence";
    pairs(2'000, -4 * ms / 10);
    EXPECT_EQ(timing.synchronised(), Synchronised::yes);
    timing.restart();
    EXPECT_FALSE(timing.newest());
    EXPECT_EQ(timing.synchronised(), Synchronised::unknown);
}

TEST(PairTiming, FramesThatDriftPastEachOtherAreNeverCalledSynchronised) {
    constexpr std::int64_t interval = 33'333'333;
    for (const std::int64_t ppm : {3, 10, 50}) {
        PairTiming timing(interval);
        // From a sixth of the interval on one side to a sixth on the other.
        const std::int64_t pairs = interval / 3 * 1'000'000 / ppm / interval;
        for (std::int64_t i = 0; i < pairs; ++i) {
            timing.add(i * interval, i * interval - interval / 6 + i * interval * ppm / 1'000'000);
            ASSERT_NE(timing.synchronised(), Synchronised::yes) << ppm << " ppm, pair " << i;
        }
        EXPECT_EQ(timing.synchronised(), Synchronised::no);
        // The same from the middle on: it is not known until it shows.
        timing.restart();
        for (std::int64_t i = 0; i < pairs / 2; ++i) {
            timing.add(i * interval, i * interval + i * interval * ppm / 1'000'000);
            ASSERT_NE(timing.synchronised(), Synchronised::yes) << ppm << " ppm, pair " << i;
        }
        EXPECT_EQ(timing.synchronised(), Synchronised::no);
    }
}

}  // namespace
}  // namespace disparityd::capture
