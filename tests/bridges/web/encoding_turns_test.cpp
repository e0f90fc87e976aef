// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/live/encoding_turns.h"

#include <future>
#include <string>

#include <gtest/gtest.h>

namespace disparityd::web {
namespace {

TEST(EncodingTurnsTest, OnePeersJobsWaitForOneOfAnothersEach) {
    EncodingTurns turns;
    std::promise<void> all_are_there;
    std::string order;
    turns.add("first", [wait = all_are_there.get_future().share()] { wait.wait(); });
    for (int i = 0; i < 5; ++i) {
        turns.add("many", [&order, i] { order += "m" + std::to_string(i) + ' '; });
    }
    turns.add("few", [&order] { order += "f0 "; });
    turns.add("few", [&order] { order += "f1 "; });
    all_are_there.set_value();
    turns.join();
    EXPECT_EQ(order, "m0 f0 m1 f1 m2 m3 m4 ");
}

}  // namespace
}  // namespace disparityd::web
