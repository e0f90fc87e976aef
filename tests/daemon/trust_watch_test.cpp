// SPDX-License-Identifier: Apache-2.0
#include "daemon/trust_watch.h"

#include <array>
#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/scan.h"

namespace disparityd::daemon {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr std::uint32_t full_trust = 255U << proto::trust_shift;
constexpr TrustWatch::Time begin{1h};

TEST(TrustWatch, BeforeTheFirstFrameNothingIsSaid) {
    TrustWatch watch;
    EXPECT_FALSE(watch.finding(begin));
    EXPECT_THAT(watch.check(begin), IsEmpty());
}

TEST(TrustWatch, AGoodFrameHasNoDoubts) {
    TrustWatch watch;
    watch.note(full_trust);
    const auto finding = watch.finding(begin);
    ASSERT_TRUE(finding);
    EXPECT_EQ(finding->ratio, 1);
    EXPECT_THAT(finding->doubts, IsEmpty());
    EXPECT_EQ(finding->alarm, "");
}

TEST(TrustWatch, SectorsInDoubtAreCounted) {
    TrustWatch watch;
    watch.note_scan({});
    EXPECT_FALSE(watch.scan_status());
    std::array<std::uint8_t, proto::scan_bytes(3)> record{};
    const auto note = [&](std::array<std::uint32_t, 3> doubts) {
        proto::ScanHead head{};
        head.sectors = 3;
        std::memcpy(record.data(), &head, sizeof head);
        for (std::size_t s = 0; s < doubts.size(); ++s) {
            proto::ScanSector sector;
            sector.doubts = static_cast<std::uint16_t>(doubts[s] >> proto::scan_doubt_shift);
            std::memcpy(record.data() + proto::scan_bytes(s), &sector, sizeof sector);
        }
        watch.note_scan({record.data(), static_cast<int>(record.size()), 1, static_cast<int>(record.size())});
        return watch.scan_status().value();
    };
    const auto found = note({proto::doubt_dark | proto::doubt_too_near, 0, proto::doubt_dark});
    EXPECT_EQ(found.sectors(), 3U);
    EXPECT_EQ(found.doubted(), 2U);
    ASSERT_EQ(found.doubts_size(), 2);
    EXPECT_EQ(found.doubts(0).doubt(), "dark");
    EXPECT_EQ(found.doubts(0).sectors(), 2U);
    EXPECT_EQ(found.doubts(1).doubt(), "too-near");
    EXPECT_EQ(found.doubts(1).sectors(), 1U);
    EXPECT_EQ(note({}).doubted(), 0U);
}

TEST(TrustWatch, AnAlarmIsToldWhenItBeginsAndWhenItEnds) {
    TrustWatch watch;
    watch.note(full_trust | proto::doubt_dirty_eye);
    EXPECT_THAT(watch.check(begin),
                ElementsAre("alarm dirty-eye: a part of one eye stays dull where the other eye sees "
                            "texture; clean its lens, and the window in front of it"));
    EXPECT_THAT(watch.check(begin + 5s), IsEmpty());
    EXPECT_EQ(watch.finding(begin + 5s)->alarm,
              "dirty-eye for 5 s: a part of one eye stays dull where the other eye "
              "sees texture; clean its lens, and the window in front of it");
    watch.note(full_trust);
    EXPECT_THAT(watch.check(begin + 7s), ElementsAre("the alarm dirty-eye is over after 7 s"));
    EXPECT_EQ(watch.finding(begin + 7s)->alarm, "");
}

TEST(TrustWatch, AlarmsAreToldEachForItself) {
    TrustWatch watch;
    watch.note(full_trust | proto::doubt_covered_eye);
    EXPECT_EQ(watch.check(begin).size(), 1U);
    watch.note(full_trust | proto::doubt_covered_eye | proto::doubt_misaligned);
    EXPECT_EQ(watch.check(begin + 1s).size(), 1U);
}

// The light will change.
TEST(TrustWatch, DarknessIsADoubtAndNoAlarm) {
    TrustWatch watch;
    watch.note(full_trust | proto::doubt_dark);
    EXPECT_THAT(watch.check(begin), IsEmpty());
    EXPECT_THAT(watch.finding(begin)->doubts, ElementsAre("dark"));
    EXPECT_EQ(watch.finding(begin)->alarm, "");
}

}  // namespace
}  // namespace disparityd::daemon
