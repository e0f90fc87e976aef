// SPDX-License-Identifier: Apache-2.0
#include "bridges/program/rate_limit.h"

#include <gtest/gtest.h>

namespace disparityd::bridges {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(RateLimit, LetsThroughWhatIsAllowed) {
    const RateLimit::Clock::time_point start{seconds(1000)};
    RateLimit limit(10);
    int passed = 0;
    for (int ms = 0; ms < 10'000; ++ms) {
        passed += limit.pass(start + milliseconds(ms)) ? 1 : 0;
    }
    EXPECT_GE(passed, 99);
    EXPECT_LE(passed, 101);
}

TEST(RateLimit, LosesNothingOfASourceOfThatRateThatIsNotEven) {
    const RateLimit::Clock::time_point start{seconds(1000)};
    RateLimit limit(10);
    for (int i = 0; i < 1000; ++i) {
        const int early_or_late = i % 2 == 0 ? -10 : 10;
        EXPECT_TRUE(limit.pass(start + milliseconds(100 * i + early_or_late))) << i;
    }
}

TEST(RateLimit, APauseIsNotMadeUpFor) {
    const RateLimit::Clock::time_point start{seconds(1000)};
    RateLimit limit(10);
    EXPECT_TRUE(limit.pass(start));
    int passed = 0;
    for (int ms = 0; ms < 1000; ++ms) {
        passed += limit.pass(start + seconds(100) + milliseconds(ms)) ? 1 : 0;
    }
    EXPECT_LE(passed, 11);
}

}  // namespace
}  // namespace disparityd::bridges
