// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/liveness.h"

#include <gtest/gtest.h>

namespace disparityd::web {
namespace {

using namespace std::chrono_literals;

constexpr Liveness::Time first_look{1000h};

TEST(LivenessTest, APeerThatAsksForNothingEnds) {
    Liveness liveness(first_look);
    liveness.heard(first_look + 29s);
    EXPECT_EQ(liveness.look(first_look + 29s), Liveness::Verdict::well);
    EXPECT_EQ(liveness.look(first_look + 30s), Liveness::Verdict::end);
}

TEST(LivenessTest, APeerThatHasAskedOnceMayPause) {
    Liveness liveness(first_look);
    liveness.asked();
    liveness.heard(first_look + 1h);
    EXPECT_EQ(liveness.look(first_look + 1h), Liveness::Verdict::well);
}

TEST(LivenessTest, ASilentPeerIsAskedAndThenEnds) {
    Liveness liveness(first_look);
    liveness.asked();
    liveness.heard(first_look + 10s);
    EXPECT_EQ(liveness.look(first_look + 29s), Liveness::Verdict::well);
    EXPECT_EQ(liveness.look(first_look + 30s), Liveness::Verdict::ask);
    EXPECT_EQ(liveness.look(first_look + 69s), Liveness::Verdict::ask);
    EXPECT_EQ(liveness.look(first_look + 70s), Liveness::Verdict::end);
    liveness.heard(first_look + 69s);
    EXPECT_EQ(liveness.look(first_look + 70s), Liveness::Verdict::well);
}

}  // namespace
}  // namespace disparityd::web
