// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/live/outgoing.h"

#include <gtest/gtest.h>

namespace disparityd::web {
namespace {

using namespace std::chrono_literals;

constexpr Outgoing::Time first_hold{1000h};
constexpr std::size_t mib = 1 << 20;

TEST(OutgoingTest, BytesCountUntilTheyAreSent) {
    Outgoing outgoing(10 * mib);
    auto one = outgoing.hold(4 * mib, first_hold, [] {});
    const auto other = outgoing.hold(6 * mib, first_hold, [] {});
    EXPECT_EQ(outgoing.bytes(), 10 * mib);
    EXPECT_FALSE(outgoing.has_room(first_hold));
    one.reset();
    EXPECT_EQ(outgoing.bytes(), 6 * mib);
    EXPECT_TRUE(outgoing.has_room(first_hold));
    EXPECT_FALSE(outgoing.has_room(first_hold, 6 * mib)) << "snapshots have a lower limit";
}

TEST(OutgoingTest, WhoReadsNothingMakesRoomWhenItIsNeeded) {
    Outgoing outgoing(10 * mib);
    int dropped = 0;
    int small_dropped = 0;
    const auto large = outgoing.hold(8 * mib, first_hold, [&] { ++dropped; });
    const auto small = outgoing.hold(1 * mib, first_hold, [&] { ++small_dropped; });
    EXPECT_TRUE(outgoing.has_room(first_hold + 1h));
    EXPECT_EQ(dropped, 0) << "nobody needs it";
    const auto next = outgoing.hold(2 * mib, first_hold + 1h, [] {});
    EXPECT_TRUE(outgoing.has_room(first_hold + 1h));
    EXPECT_EQ(dropped, 1);
    EXPECT_EQ(small_dropped, 0) << "the one with the most bytes ends";
    EXPECT_EQ(outgoing.bytes(), 3 * mib);
    EXPECT_TRUE(outgoing.has_room(first_hold + 2h));
    EXPECT_EQ(dropped, 1);
}

TEST(OutgoingTest, AMiBASecondIsFastEnough) {
    Outgoing outgoing(10 * mib);
    int dropped = 0;
    const auto load = outgoing.hold(10 * mib, first_hold, [&] { ++dropped; });
    EXPECT_FALSE(outgoing.has_room(first_hold + 11s));
    EXPECT_EQ(dropped, 0);
    EXPECT_TRUE(outgoing.has_room(first_hold + 13s));
    EXPECT_EQ(dropped, 1);
}

}  // namespace
}  // namespace disparityd::web
