// SPDX-License-Identifier: Apache-2.0
#include "daemon/core_share.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/cores.h"

namespace disparityd::daemon {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

Config with_cores(double cores, int workers = 0) {
    Config config;
    config.pipeline.cores = cores;
    config.pipeline.workers = workers;
    return config;
}

TEST(CoreShare, WorkersAreTheCoresRoundedUp) {
    const int here = pipeline::cores_worth();
    EXPECT_EQ(configured_workers(Config{}), 0) << "one for each core";
    EXPECT_EQ(configured_workers(with_cores(0.3)), 1);
    EXPECT_EQ(configured_workers(with_cores(1)), 1);
    EXPECT_EQ(configured_workers(with_cores(here - 0.5)), here);
    EXPECT_EQ(configured_workers(with_cores(256)), here) << "more threads than cores would wait for each other";
    EXPECT_EQ(configured_workers(with_cores(1.5, 7)), 7) << "who says how many means it";
}

TEST(CoreShare, WhatItMeansIsTold) {
    EXPECT_EQ(core_share_note(Config{}, 2, true), "");
    EXPECT_EQ(core_share_note(with_cores(0.5), 1, true),
              "[pipeline] cores = 0.5: at most that much processor time of the whole process, on average over 10 s; 1 "
              "worker; frames beyond it are left out, evenly");
    EXPECT_THAT(core_share_note(with_cores(0.5), 1, false), HasSubstr("a replay is slowed, no frame is left out"));
    EXPECT_THAT(core_share_note(with_cores(256), 2, true), StartsWith("[pipeline] cores = 256: no less than the "));
}

}  // namespace
}  // namespace disparityd::daemon
