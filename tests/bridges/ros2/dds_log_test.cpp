// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros2/dds_log.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>

namespace disparityd::ros2 {
namespace {

/// As Cyclone DDS does.
void warn_thrice() {
    for (int i = 0; i < 3; ++i) {
        dds_log(DDS_LC_WARNING, __FILE__, __LINE__, __func__, "malformed packet received from %d\n", i);
    }
}

TEST(Ros2DdsLog, WhatTheNetworkSendsDoesNotFillTheJournal) {
    std::vector<std::string> lines;
    DdsLog log([&](const std::string& line) { lines.push_back(line); });
    warn_thrice();
    EXPECT_THAT(lines, testing::Each(testing::StartsWith("DDS: malformed packet received")));
    EXPECT_EQ(lines.size(), 3U) << "all are said of a node that is being made";
    log.calm();
    lines.clear();
    warn_thrice();
    EXPECT_EQ(lines.size(), 1U);
}

}  // namespace
}  // namespace disparityd::ros2
