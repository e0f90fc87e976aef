// SPDX-License-Identifier: Apache-2.0
//
// `process --scan`: the file of obstacle scans, its options, and what is refused.
#include <algorithm>
#include <chrono>
#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "capture/frame_source.h"
#include "capture/recording/recording_writer.h"
#include "tests/tools/made_input.h"
#include "tests/tools/run_program.h"
#include "tools/command_line/csv.h"
#include "tools/ctl/scan/scan_csv.h"

namespace disparityd::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr const char* scanned_scene = "scene:vga?width=160&height=120&frames=3";

class ProcessScanTest : public FolderTest {
protected:
    Outcome process(const std::string& folder, std::vector<std::string> more) const {
        more.insert(more.begin(), {"process", scanned_scene, "-o", path(folder), "--disparities", "32"});
        return run(DISPARITYCTL, more);
    }

    std::vector<std::vector<std::string>> rows(const std::string& name) const {
        std::istringstream text(read_file(path(name)));
        std::vector<std::vector<std::string>> rows;
        for (std::string line; std::getline(text, line);) {
            rows.push_back(tools::csv_fields(line));
        }
        return rows;
    }

    nlohmann::json scan_options(const std::string& folder) const {
        return nlohmann::json::parse(read_file(path(folder + "/geometry.json")))["scan"];
    }

    void expect_refused(const Outcome& outcome, const testing::Matcher<std::string>& says) const {
        EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
        EXPECT_THAT(outcome.err, says);
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        EXPECT_FALSE(std::filesystem::exists(path("refused")));
    }
};

TEST_F(ProcessScanTest, MasksOfTheRobotItselfAreApplied) {
    const Outcome outcome = process("all", {"--scan", path("all.csv"), "--mask-polygon", "0,0 159,0 159,119 0,119"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto lines = rows("all.csv");
    const auto state = std::find(lines[0].begin(), lines[0].end(), "state") - lines[0].begin();
    ASSERT_GT(lines.size(), 1U);
    for (std::size_t i = 1; i < lines.size(); ++i) {
        EXPECT_EQ(lines[i][static_cast<std::size_t>(state)], "masked") << i;
    }
    expect_refused(process("refused", {"--mask-polygon", "0,0 160,0 0,9"}),
                   AllOf(HasSubstr("160,0"), HasSubstr("0,0 to 159,119")));
    expect_refused(process("refused", {"--mask-image", path("absent.png")}), HasSubstr("absent.png"));
}

TEST_F(ProcessScanTest, ARowPerFrameAndSectorAndTheSameBytesTwice) {
    for (const char* name : {"one", "two"}) {
        const Outcome outcome = process(name, {"--scan", path(std::string(name) + ".csv"), "--scan-set", "sectors=12",
                                               "--workers", name == std::string("one") ? "1" : "3"});
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    }
    EXPECT_EQ(read_file(path("one.csv")), read_file(path("two.csv")));
    const auto table = rows("one.csv");
    ASSERT_EQ(table.size(), 1U + 3 * 12);
    for (const auto& row : table) {
        EXPECT_EQ(row.size(), table.front().size());
    }
    EXPECT_EQ(table[12][0], "0");
    EXPECT_EQ(table[13][0], "1") << "12 sectors of each frame";
    EXPECT_EQ(table[1][4], table[2][3]) << "the left edge of a sector is the right edge of the next";
    const bool any = std::any_of(table.begin(), table.end(), [](const auto& row) { return row[5] == "occupied"; });
    EXPECT_TRUE(any) << "the scene has obstacles";
}

TEST_F(ProcessScanTest, TheOptionsAreKeptBesideTheFrames) {
    ASSERT_EQ(process("sgm", {"--scan", path("sgm/scan.csv"), "--scan-set", "camera_height_m=0.5", "--scan-set",
                              "ground=configured"})
                  .exit_code,
              0)
        << "the file may lie in the folder that is made";
    EXPECT_EQ(scan_options("sgm")["camera_height_m"], 0.5);
    EXPECT_EQ(scan_options("sgm")["ground"], "configured");
    EXPECT_EQ(scan_options("sgm")["min_confidence"], 200) << "a chance";
    ASSERT_EQ(process("sad", {"--scan", path("sad.csv"), "--method", "sad"}).exit_code, 0);
    EXPECT_EQ(scan_options("sad")["min_confidence"], 1) << "a ratio of costs";
    ASSERT_EQ(process("paper", {"--scan", path("paper.csv"), "--preset", "paper", "--scan-set", "min_confidence=7"})
                  .exit_code,
              0);
    EXPECT_EQ(scan_options("paper")["min_confidence"], 7) << "as given";
    ASSERT_EQ(process("none", {}).exit_code, 0);
    EXPECT_TRUE(scan_options("none").is_null());
}

TEST_F(ProcessScanTest, WhatIsNotAllowedIsOneLine) {
    const std::vector<std::pair<std::string, std::string>> wrong{
        {"sectrs=3", "allowed: KEY=VALUE, where KEY is one of sectors"},
        {"sectors", "allowed: KEY=VALUE"},
        {"sectors=", "allowed: a whole number"},
        {"sectors=3.5", "allowed: a whole number"},
        {"sectors=99999999999999999999", "allowed: a whole number"},
        {"sectors=0", "sectors = 0: allowed is 1 to 360"},
        {"sectors=361", "sectors = 361: allowed is 1 to 360"},
        {"max_m=far", "allowed: a number"},
        {"max_m=nan", "allowed: a number"},
        {"max_m=66", "max_m = 66: allowed is 0.02 to 65"},
        {"pitch_deg=-46", "pitch_deg = -46: allowed is -45 to 45"},
        {"ground=flat", "allowed: fitted, configured, gravity or autopilot"},
        {"ground=gravity", "imu_axes = \"\": allowed is where the sensor's x, y and z axes point"},
        {"imu_axes=ahead left", "imu_axes = \"ahead left\": allowed is"},
        {"camera_left_m=11", "camera_left_m = 11: allowed is -10 to 10"},
        {"min_confidence=0", "min_confidence = 0: allowed is 1 to 255"},
        {"high_m=0", "high_m = 0: allowed is more than low_m"},
        {"", "allowed: KEY=VALUE"},
    };
    for (const auto& [setting, allowed] : wrong) {
        expect_refused(process("refused", {"--scan", path("scan.csv"), "--scan-set", setting}),
                       AllOf(HasSubstr("--scan-set"), HasSubstr(allowed)));
    }
    expect_refused(process("refused", {"--scan-set", "sectors=3"}), HasSubstr("--scan-set requires --scan"));
    expect_refused(process("refused", {"--scan", ""}), HasSubstr("--scan"));
    expect_refused(process("refused", {"--scan", path("nowhere/scan.csv")}),
                   AllOf(HasSubstr("there is no folder"), HasSubstr("nowhere")));
    EXPECT_FALSE(std::filesystem::exists(path("scan.csv")));
}

/// A recording of the rendered scene with samples of a camera that is turned by 5 degrees, its nose down.
void record_leaning_scene(const std::string& path) {
    capture::SourceOptions options;
    options.uri = scanned_scene;
    options.pace = capture::Pace::fastest;
    const auto source = capture::open_source(options);
    capture::RecordingWriter writer(path, source->info());
    std::vector<capture::SensorSample> samples(40);
    capture::RawFrame frame;
    while (source->next(frame, std::chrono::steady_clock::now() + std::chrono::hours(1)) ==
           capture::FrameSource::Next::frame) {
        for (std::size_t i = 0; i < samples.size(); ++i) {
            samples[i].flags = capture::sensor_flag_inertial;
            samples[i].monotonic_ns = frame.monotonic_ns - static_cast<std::int64_t>(samples.size() - i) * 5'000'000;
            // The axes are ahead, left and up.
            samples[i].acceleration = {-9.81F * 0.0871557F, 0, 9.81F * 0.9961947F};
        }
        frame.sensors = samples;
        writer.write(frame);
        source->give_back(frame);
    }
    writer.close();
}

TEST_F(ProcessScanTest, TheGroundOfGravityIsThatOfTheRecordingsSamples) {
    record_leaning_scene(path("leaning.mkv"));
    for (const char* name : {"one", "two"}) {
        const Outcome outcome =
            run(DISPARITYCTL, {"process", path("leaning.mkv"), "-o", path(name), "--disparities", "32", "--scan",
                               path(std::string(name) + ".csv"), "--scan-set", "ground=gravity", "--scan-set",
                               "imu_axes=ahead left up", "--scan-set", "camera_left_m=0.2"});
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        EXPECT_THAT(outcome.err, Not(HasSubstr("configured ground")));
    }
    EXPECT_EQ(read_file(path("one.csv")), read_file(path("two.csv")));
    const auto table = rows("one.csv");
    ASSERT_GT(table.size(), 1U);
    for (std::size_t i = 1; i < table.size(); ++i) {
        EXPECT_THAT(std::vector(table[i].begin() + 13, table[i].begin() + 18),
                    ElementsAre("gravity", "0", "-0.001", "0.0875", "0.0000"));
    }
    EXPECT_EQ(scan_options("one")["ground"], "gravity");
    EXPECT_EQ(scan_options("one")["imu_axes"], "ahead left up");
    EXPECT_EQ(scan_options("one")["camera_left_m"], 0.2);
}

TEST_F(ProcessScanTest, WithoutSamplesTheConfiguredGroundIsTakenAndTold) {
    const Outcome outcome = process(
        "none", {"--scan", path("none.csv"), "--scan-set", "ground=gravity", "--scan-set", "imu_axes=ahead left up"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("the configured ground was taken for 3 frames of 3"));
    EXPECT_EQ(rows("none.csv")[1][13], "configured");
}

TEST_F(ProcessScanTest, AFileThatIsThereIsLeftAlone) {
    write_text(path("scan.csv"), "somebody's");
    expect_refused(process("refused", {"--scan", path("scan.csv")}),
                   AllOf(HasSubstr("scan.csv"), HasSubstr("--force")));
    EXPECT_EQ(read_file(path("scan.csv")), "somebody's");
    ASSERT_EQ(process("out", {"--scan", path("scan.csv"), "--force"}).exit_code, 0);
    EXPECT_THAT(read_file(path("scan.csv")), Not(HasSubstr("somebody")));
}

TEST_F(ProcessScanTest, FramesWithoutACalibrationAreRefused) {
    make_kitti_folder(path("in"), 1, 64, 32);
    expect_refused(run(DISPARITYCTL, {"process", path("in"), "-o", path("refused"), "--scan", path("scan.csv")}),
                   AllOf(HasSubstr("no calibration"), HasSubstr("--calibration")));
}

TEST(ScanCsv, HasEmptyFieldsForWhatIsNotKnown) {
    proto::ScanHead head{};
    head.ground = GroundSource::held;
    head.ground_age = 4;
    head.ground_mm = -12;
    head.ground_slope_ahead = 200;
    const auto last_of = [](const proto::ScanHead& of) {
        const std::string row = tools::scan_csv_rows({7, 8, 9}, {of, std::vector<ScanSector>(1)});
        return row.substr(row.find("0.0000,") + 7);
    };
    EXPECT_EQ(last_of(head), ",,,0,\n") << "no mounting was found";
    proto::ScanHead mounted = head;
    mounted.mounting_height_mm = 1502;
    mounted.mounting_pitch_cdeg = -1250;
    EXPECT_EQ(last_of(mounted), "1.502,-12.50,0.00,0,\n");
    const std::vector<ScanSector> sectors{
        {-1000, -5, SectorState::occupied, 200, 1234, 56, 1000, -20, 900, 65535, 0b1001, 90},
        {-5, 1000, SectorState::free, 0, 0, 0, 2500, 0, 0, 0},
        {1000, 2000, SectorState::unknown, 0, 0, 0, 0, 0, 0, 0}};
    std::istringstream rows(tools::scan_csv_rows({7, 8, 9}, {head, sectors}));
    std::vector<std::string> lines;
    for (std::string line; std::getline(rows, line);) {
        lines.push_back(line);
    }
    EXPECT_THAT(lines, ElementsAre("7,8,9,-10.00,-0.05,occupied,1.234,0.056,1.000,-0.020,0.900,65535,200,held,4,-0.012,"
                                   "0.0200,0.0000,,,,90,dark dirty-eye",
                                   "7,8,9,-0.05,10.00,free,,,2.500,,,,,held,4,-0.012,0.0200,0.0000,,,,0,",
                                   "7,8,9,10.00,20.00,unknown,,,0.000,,,,,held,4,-0.012,0.0200,0.0000,,,,0,"));
    EXPECT_EQ(tools::csv_fields(tools::scan_csv_head()).size(), tools::csv_fields(lines[0]).size());
}

}  // namespace
}  // namespace disparityd::test
