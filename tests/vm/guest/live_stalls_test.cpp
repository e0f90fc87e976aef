// SPDX-License-Identifier: Apache-2.0
//
// A camera that stops sending: what the daemon tries, in which order, and what the client sees of it.
#include <gtest/gtest.h>

#include "tests/vm/guest/live_fixture.h"

namespace vm_guest {
namespace {

class LiveStalls : public LiveTest {
protected:
    static void SetUpTestSuite() { start({"source.stall_ms=1000"}); }

    void SetUp() override { ASSERT_TRUE(daemon_->recovers()); }
};

TEST_F(LiveStalls, DeadTransfersAreCuredByARestartOfTheStream) {
    const Status before = daemon_->status();
    camera_->tell("stall 5");
    EXPECT_TRUE(daemon_->wait_for(
        [&](const Status& status) { return status.camera().restarts() > before.camera().restarts(); }));
    camera_->tell("stall 0");
    EXPECT_TRUE(streams());
    EXPECT_EQ(daemon_->status().camera().resets(), before.camera().resets());
}

TEST_F(LiveStalls, AFreezeShowsAndEndsWithTheThaw) {
    camera_->tell("freeze");
    EXPECT_TRUE(daemon_->wait_for([](const Status& status) {
        return status.camera().state() == "stalled" && status.state() == "waiting" && !status.detail().empty();
    }));
    camera_->tell("thaw");
    EXPECT_TRUE(streams());
}

TEST_F(LiveStalls, AFreezeThatAStreamRestartEnds) {
    const Status before = daemon_->status();
    camera_->tell("freeze restart");
    EXPECT_TRUE(daemon_->wait_for(
        [&](const Status& status) { return status.camera().restarts() > before.camera().restarts(); }));
    EXPECT_TRUE(streams());
    EXPECT_EQ(daemon_->status().camera().resets(), before.camera().resets());
}

TEST_F(LiveStalls, AFreezeThatOnlyAResetEndsIsEndedByOneAfterGentlerMeans) {
    const Status before = daemon_->status();
    camera_->tell("freeze reset");
    EXPECT_TRUE(
        daemon_->wait_for([&](const Status& status) { return status.camera().resets() > before.camera().resets(); }));
    EXPECT_TRUE(streams());
    const Status after = daemon_->status();
    EXPECT_GT(after.camera().restarts(), before.camera().restarts());
    EXPECT_GT(after.camera().reopens(), before.camera().reopens());
    const std::string log = daemon_->log();
    const std::size_t reset = log.rfind("reset on the USB");
    const std::size_t reopen = log.rfind("opened anew", reset);
    EXPECT_LT(log.rfind("restarted", reopen), reopen);
    EXPECT_LT(reopen, reset);
}

}  // namespace
}  // namespace vm_guest
