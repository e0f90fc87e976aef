// SPDX-License-Identifier: Apache-2.0
#include "bridges/mavlink/alarm_texts.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace disparityd::mavlink {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class AlarmTextsTest : public testing::Test {
protected:
    /// Returns the texts that are sent for a frame, each behind its severity.
    std::vector<std::string> tell(std::uint32_t flags, std::chrono::seconds at, bool sent = true) {
        std::vector<std::string> texts;
        texts_.tell(flags, AlarmTexts::Clock::time_point(1h) + at, [&](const Message& message) {
            const auto& payload = message.payload;
            texts.push_back(std::to_string(payload[0]) + ' ' + reinterpret_cast<const char*>(payload.data() + 1));
            return sent;
        });
        return texts;
    }

    AlarmTexts texts_;
};

TEST_F(AlarmTextsTest, AnAlarmIsToldWhenItBeginsAndWhenItEnds) {
    EXPECT_THAT(tell(0, 0s), IsEmpty());
    EXPECT_THAT(tell(proto::doubt_dirty_eye, 1s), ElementsAre("4 stereo camera: dirty-eye"));
    EXPECT_THAT(tell(proto::doubt_dirty_eye, 60s), IsEmpty());
    EXPECT_THAT(tell(0, 61s), ElementsAre("6 stereo camera: dirty-eye is over"));
}

TEST_F(AlarmTextsTest, AnAlarmThatComesAndGoesIsToldAtMostEveryFiveSeconds) {
    EXPECT_EQ(tell(proto::doubt_blurred, 1s).size(), 1U);
    EXPECT_THAT(tell(0, 3s), IsEmpty());
    EXPECT_THAT(tell(proto::doubt_blurred, 4s), IsEmpty());
    EXPECT_EQ(tell(0, 6s).size(), 1U);
}

TEST_F(AlarmTextsTest, WhatCouldNotBeSentIsDueAgain) {
    EXPECT_EQ(tell(proto::doubt_misaligned, 1s, false).size(), 1U);
    EXPECT_EQ(tell(proto::doubt_misaligned, 1s).size(), 1U);
    EXPECT_THAT(tell(proto::doubt_misaligned, 2s), IsEmpty());
}

TEST_F(AlarmTextsTest, DarknessIsNoAlarm) {
    EXPECT_THAT(tell(proto::doubt_dark | proto::doubt_saturated, 1s), IsEmpty());
}

TEST(StatusText, ALongTextIsCut) {
    const Message message = status_text(Severity::info, std::string(80, 'a'));
    EXPECT_EQ(message.payload.size(), status_text_kind.length);
    EXPECT_EQ(message.payload[50], 'a');
    EXPECT_EQ(message.payload[51], 0);
}

}  // namespace
}  // namespace disparityd::mavlink
