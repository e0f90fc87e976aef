// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/pair_timing.h"

#include <gtest/gtest.h>

namespace disparityd::capture {
namespace {

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
    EXPECT_FALSE(timing.unsynchronised());
    pairs(520, -2 * ms);
    EXPECT_EQ(timing.newest()->median_ns, -2 * ms);
    EXPECT_TRUE(timing.unsynchronised());
    pairs(520, -6 * ms / 10);
    EXPECT_TRUE(timing.unsynchronised()) << "it stays until a twentieth";
    pairs(520, -4 * ms / 10);
    EXPECT_FALSE(timing.unsynchronised());
    timing.restart();
    EXPECT_FALSE(timing.newest());
}

}  // namespace
}  // namespace disparityd::capture
