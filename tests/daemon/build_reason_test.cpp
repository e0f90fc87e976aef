// SPDX-License-Identifier: Apache-2.0
#include "daemon/build_reason.h"

#include <gtest/gtest.h>

namespace disparityd::daemon {
namespace {

constexpr BuildReason every_reason[] = {BuildReason::start, BuildReason::reload, BuildReason::source_changed,
                                        BuildReason::rollback};

TEST(BuildReason, AFailedBuildOnlyEndsTheDaemonAtTheStart) {
    EXPECT_EQ(after_failed_build(BuildReason::start), FailureAction::end_daemon);
    EXPECT_EQ(after_failed_build(BuildReason::reload), FailureAction::refuse_reload);
    EXPECT_EQ(after_failed_build(BuildReason::source_changed), FailureAction::keep_source);
    EXPECT_EQ(after_failed_build(BuildReason::rollback), FailureAction::wait_for_reload);
}

TEST(BuildReason, ATakeOverThatFailsBeforeAnyEngineRanEndsTheDaemon) {
    EXPECT_EQ(after_failed_take_over(BuildReason::start, EngineInUse::none), FailureAction::end_daemon);
}

TEST(BuildReason, ATakeOverThatFailsWhileTheOldEngineRunsChangesNothing) {
    for (const BuildReason reason : every_reason) {
        EXPECT_EQ(after_failed_take_over(reason, EngineInUse::running), FailureAction::refuse_reload);
    }
}

// Rolling back from a rollback would go on for ever.
TEST(BuildReason, TheConfigurationBeforeIsPutBackOnce) {
    EXPECT_EQ(after_failed_take_over(BuildReason::reload, EngineInUse::stopped), FailureAction::roll_back);
    EXPECT_EQ(after_failed_take_over(BuildReason::source_changed, EngineInUse::stopped), FailureAction::roll_back);
    EXPECT_EQ(after_failed_take_over(BuildReason::rollback, EngineInUse::stopped), FailureAction::wait_for_reload);
}

}  // namespace
}  // namespace disparityd::daemon
