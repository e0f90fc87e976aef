// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/scan/scan_text.h"

#include <gmock/gmock.h>

namespace disparityd::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

tools::ScanReading reading() {
    tools::ScanReading reading;
    reading.frame.sequence = 42;
    reading.frame.f = 500;
    reading.frame.baseline_mm = 120;
    reading.age_ns = 31'400'000;
    reading.rate = 14.96;
    reading.scan.ground = disparity::GroundSource::held;
    reading.scan.ground_age = 3;
    reading.scan.max_m = 20;
    reading.scan.sectors = {{-10, 0, disparity::SectorState::occupied, 2.5, 0.1, 2, 0.1, 0.9, 80, 200},
                            {0, 10.1, disparity::SectorState::occupied, 1.25, 0.02, 1, 0.05, 0.6, 700, 210},
                            {10.1, 20, disparity::SectorState::free, 0, 0, 4, 0, 0, 0, 0},
                            {20, 30, disparity::SectorState::unknown, 0, 0, 0, 0, 0, 0, 0}};
    return reading;
}

TEST(ScanText, SaysWhatIsNearest) {
    EXPECT_THAT(tools::scan_parts(reading()),
                ElementsAre("frame 42", "age 31 ms", "15.0/s", "nearest 1.25 m 5 deg left", "0.05 to 0.60 m high",
                            "25 % free", "25 % unknown", "ground held from 3 frames ago"));
}

TEST(ScanText, SaysWhatIsNearerThanCanBeMeasured) {
    auto near = reading();
    near.scan.sectors[1].pixels = 0;
    EXPECT_THAT(tools::scan_parts(near), testing::Contains("nearest at most 1.25 m 5 deg left"));
    EXPECT_EQ(tools::scan_json(near)["sectors"][1]["near"], true);
}

TEST(ScanText, SaysWhichMountingTheFloorShows) {
    auto seen = reading();
    EXPECT_TRUE(tools::scan_json(seen)["mounting"].is_null());
    seen.scan.mounting = {1.204, 12.3, -0.5};
    EXPECT_EQ(tools::scan_parts(seen).back(), "floor seen from 1.20 m, pitch 12.3, roll -0.5");
    EXPECT_EQ(tools::scan_json(seen)["mounting"]["pitch_deg"], 12.3);
}

TEST(ScanText, SaysWhatIsWrong) {
    auto bad = reading();
    bad.age_ns = 2'500'000'000;
    bad.rate.reset();
    bad.frame.baseline_mm = 0;
    bad.frame.flags = disparity::FrameFlags::synthetic;
    bad.scan.ground = disparity::GroundSource::fitted;
    bad.scan.sectors = {{}, {}};
    EXPECT_THAT(tools::scan_parts(bad), ElementsAre("frame 42", "OLD: 2.5 s", "-/s", "no calibration: nothing is known",
                                                    "0 % free", "100 % unknown", "ground fitted", "synthetic"));
    bad.frame.baseline_mm = 120;
    EXPECT_THAT(tools::scan_parts(bad), testing::Contains("no obstacle seen"));
}

TEST(ScanText, SaysWhyAFrameIsTrustedLess) {
    auto doubted = reading();
    EXPECT_EQ(tools::scan_json(doubted)["doubts"].dump(), "[]");
    doubted.frame.flags = disparity::dirty_eye | disparity::dark | 100U << 24U;
    EXPECT_EQ(tools::scan_parts(doubted).back(), "DOUBTS: dark dirty-eye");
    EXPECT_THAT(tools::scan_line(doubted), testing::EndsWith(", dark dirty-eye"));
    EXPECT_EQ(tools::scan_json(doubted)["trust"], 100);
    EXPECT_EQ(tools::scan_json(doubted)["doubts"].dump(), R"(["dark","dirty-eye"])");
}

TEST(ScanText, SaysWhichSectorsAreInDoubt) {
    auto doubted = reading();
    doubted.scan.sectors[0].doubts = disparity::dirty_eye;
    doubted.scan.sectors[0].trust = 90;
    doubted.scan.sectors[2].doubts = disparity::dirty_eye | disparity::too_near;
    EXPECT_THAT(tools::scan_parts(doubted), testing::Contains("50 % in doubt: dirty-eye too-near"));
    EXPECT_THAT(tools::scan_line(doubted), testing::EndsWith(", 50 % of the sectors: dirty-eye too-near"));
    const tools::Json json = tools::scan_json(doubted);
    EXPECT_EQ(json["doubtful"], 0.5);
    EXPECT_EQ(json["doubts"].dump(), "[]") << "those of the frame";
    EXPECT_EQ(json["sectors"][0]["trust"], 90);
    EXPECT_EQ(json["sectors"][2]["doubts"].dump(), R"(["dirty-eye","too-near"])");
}

TEST(ScanText, SaysWhereTheGroundComesFrom) {
    tools::ScanReading one = reading();
    one.scan.ground = disparity::GroundSource::gravity;
    EXPECT_EQ(tools::scan_parts(one).back(), "ground gravity");
    one.scan.ground = static_cast<disparity::GroundSource>(17);
    EXPECT_EQ(tools::scan_parts(one).back(), "ground other") << "that of a later daemon";
    EXPECT_EQ(tools::scan_json(one)["ground"]["source"], "other");
}

TEST(ScanText, BreaksLinesBetweenParts) {
    EXPECT_THAT(tools::wrapped({"one", "two", "three"}, 80), ElementsAre("one, two, three"));
    EXPECT_THAT(tools::wrapped({"one", "two", "three"}, 9), ElementsAre("one, two,", "three"));
    EXPECT_THAT(tools::wrapped({"one", "two", "three"}, 8), ElementsAre("one,", "two,", "three"));
    EXPECT_THAT(tools::wrapped({"a part that is longer\033[2J"}, 10), ElementsAre(testing::StartsWith("a part")));
    EXPECT_LE(tools::wrapped({"a part that is longer"}, 10)[0].size(), 13U) << "cut, and marked with dots";
    EXPECT_THAT(tools::wrapped({"\033[2J"}, 10), ElementsAre("?[2J"));
    EXPECT_THAT(tools::wrapped({}, 10), testing::IsEmpty());
}

TEST(ScanText, LinesStandBelowTheirHeading) {
    EXPECT_EQ(tools::scan_heading(),
              "    frame     age  scans/s  nearest  bearing         height  free  occupied  unknown  ground");
    EXPECT_EQ(tools::scan_line(reading()),
              "       42   31 ms     15.0   1.25 m      5.0   0.05 to 0.60  25 %      50 %     25 %  held");
    auto empty = reading();
    empty.scan.sectors.clear();
    empty.frame.f = 0;
    EXPECT_EQ(tools::scan_line(empty),
              "       42   31 ms     15.0        -        -              -   0 %       0 %      0 %  held, no "
              "calibration");
    EXPECT_EQ(tools::no_scan_line("it sleeps"), "no scan: it sleeps");
}

TEST(ScanText, JsonHasNullForWhatIsNotKnown) {
    const tools::Json json = tools::scan_json(reading());
    EXPECT_EQ(json["sequence"], 42);
    EXPECT_EQ(json["calibrated"], true);
    EXPECT_EQ(json["synthetic"], false);
    EXPECT_EQ(json["nearest"].dump(), R"({"distance_m":1.25,"bearing_deg":5.05,"low_m":0.05,"high_m":0.6})");
    EXPECT_EQ(json["free"], 0.25);
    EXPECT_EQ(json["occupied"], 0.5);
    EXPECT_EQ(json["unknown"], 0.25);
    EXPECT_EQ(json["ground"]["source"], "held");
    EXPECT_EQ(json["ground"]["age"], 3);
    ASSERT_EQ(json["sectors"].size(), 4U);
    EXPECT_EQ(json["sectors"][0].dump(),
              R"({"from_deg":-10.0,"to_deg":0.0,"state":"occupied","distance_m":2.5,"sigma_m":0.1,"free_m":2.0,)"
              R"("low_m":0.1,"high_m":0.9,"pixels":80,"confidence":200,"near":false,"trust":0,"doubts":[]})");
    EXPECT_EQ(json["sectors"][2].dump(),
              R"({"from_deg":10.1,"to_deg":20.0,"state":"free","distance_m":null,"sigma_m":null,"free_m":4.0,)"
              R"("low_m":null,"high_m":null,"pixels":null,"confidence":null,"near":false,"trust":0,"doubts":[]})");
    auto bare = reading();
    bare.rate.reset();
    bare.scan.sectors.clear();
    EXPECT_TRUE(tools::scan_json(bare)["scans_per_second"].is_null());
    EXPECT_TRUE(tools::scan_json(bare)["nearest"].is_null());
    EXPECT_EQ(tools::no_scan_json("it sleeps").dump(), R"({"sequence":null,"why":"it sleeps"})");
}

}  // namespace
}  // namespace disparityd::test
