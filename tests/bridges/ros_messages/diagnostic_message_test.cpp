// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros_messages/diagnostic_message.h"

#include <map>

#include <gtest/gtest.h>

#include "tests/bridges/ros_messages/cdr_reader.h"
#include "tests/bridges/ros_messages/message_frames.h"

namespace disparityd::ros {
namespace {

struct Entry {
    int level = -1;
    std::string line;
    std::string hardware;
    std::map<std::string, std::string> values;
};

Entry entry_in(const std::string& message) {
    test::CdrReader cdr(message);
    EXPECT_EQ(cdr.header(), "3.0 ");
    EXPECT_EQ(cdr.get<std::uint32_t>(), 1U);
    Entry entry;
    entry.level = cdr.get<std::uint8_t>();
    EXPECT_EQ(cdr.text(), "disparityd: front");
    entry.line = cdr.text();
    entry.hardware = cdr.text();
    for (auto left = cdr.get<std::uint32_t>(); left > 0; --left) {
        const std::string key(cdr.text());
        entry.values[key] = cdr.text();
    }
    EXPECT_EQ(cdr.left(), 0U);
    return entry;
}

Entry entry_of(const v1::Status& status) {
    return entry_in(diagnostic_message(status, "disparityd: front", 3'000'000'000));
}

TEST(RosDiagnostic, ADaemonThatRunsIsOk) {
    v1::Status status = test::daemon_status();
    status.clear_notices();
    status.mutable_camera()->set_model("ZED 2");
    status.mutable_camera()->set_serial("123");
    const Entry entry = entry_of(status);
    EXPECT_EQ(entry.level, 0);
    EXPECT_EQ(entry.line, "running");
    EXPECT_EQ(entry.hardware, "ZED 2 123");
    EXPECT_EQ(entry.values.at("source"), "scene:vga@15");
    EXPECT_EQ(entry.values.at("published"), "4321");
}

TEST(RosDiagnostic, WhatSomebodyMustKnowIsAWarning) {
    v1::Status status = test::daemon_status();
    EXPECT_EQ(entry_of(status).level, 1);
    EXPECT_EQ(entry_of(status).line, "a notice");
    EXPECT_EQ(entry_of(status).values.at("notice"), "a notice");
    status.mutable_trust()->set_alarm("the left eye is covered");
    EXPECT_EQ(entry_of(status).line, "the left eye is covered") << "goes before a notice";
    status = {};
    status.set_state("waiting");
    status.set_detail("no camera");
    EXPECT_EQ(entry_of(status).level, 1);
    EXPECT_EQ(entry_of(status).line, "no camera");
}

TEST(RosDiagnostic, ADaemonThatIsAwayIsStale) {
    const Entry entry = entry_in(stale_diagnostic("no daemon", "disparityd: front", 3'000'000'000));
    EXPECT_EQ(entry.level, 3);
    EXPECT_EQ(entry.line, "no daemon");
    EXPECT_TRUE(entry.values.empty());
}

TEST(RosDiagnostic, FramesWithoutAStatusAreAWarning) {
    const Entry entry = entry_in(no_status_diagnostic("no socket", "disparityd: front", 3'000'000'000));
    EXPECT_EQ(entry.level, 1);
    EXPECT_EQ(entry.line, "frames come, and the daemon tells no status: no socket");
}

}  // namespace
}  // namespace disparityd::ros
