// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/number_ring.h"

#include <gtest/gtest.h>

namespace disparityd::capture {
namespace {

TEST(NumberRing, GivesNumbersInTheOrderInWhichTheyCame) {
    NumberRing ring(3);
    EXPECT_TRUE(ring.empty());
    // More numbers than places, so that it wraps around.
    ring.push(0);
    ring.push(1);
    for (std::size_t next = 2; next < 9; ++next) {
        ring.push(next);
        EXPECT_EQ(ring.front(), next - 2);
        EXPECT_EQ(ring.pop(), next - 2);
    }
    EXPECT_EQ(ring.pop(), 7U);
    EXPECT_EQ(ring.pop(), 8U);
    EXPECT_TRUE(ring.empty());
}

}  // namespace
}  // namespace disparityd::capture
