// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/scan/rate_limit.h"

#include <gtest/gtest.h>

namespace disparityd::test {
namespace {

using std::chrono::milliseconds;

/// Returns how many of the events of some seconds are let through; they come every `step`.
int let_through(tools::RateLimit& limit, int from_ms, int to_ms, int step_ms) {
    int count = 0;
    for (int at = from_ms; at < to_ms; at += step_ms) {
        count += limit.allows(tools::RateLimit::Time(milliseconds(at))) ? 1 : 0;
    }
    return count;
}

TEST(RateLimit, LetsSoManyThrough) {
    tools::RateLimit two(2);
    EXPECT_EQ(let_through(two, 100'000, 110'000, 66), 20);
    EXPECT_EQ(let_through(two, 200'000, 200'400, 66), 1) << "a pause saves nothing up";
    tools::RateLimit ten(10);
    EXPECT_EQ(let_through(ten, 0, 1'000, 66), 10);
    tools::RateLimit slow_events(10);
    EXPECT_EQ(let_through(slow_events, 0, 1'000, 200), 5);
    tools::RateLimit all(std::nullopt);
    EXPECT_EQ(let_through(all, 0, 1'000, 1), 1'000);
}

}  // namespace
}  // namespace disparityd::test
