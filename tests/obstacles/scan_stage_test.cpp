// SPDX-License-Identifier: Apache-2.0
#include "obstacles/scan_stage.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace disparityd::test {
namespace {

using testing::HasSubstr;

/// A floor 0.3 m below the camera, and a post 1.5 m ahead.
class ScanStageTest : public testing::Test {
protected:
    ScanStageTest() : disparity_(width * height), confidence_(width * height, 250) {
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const bool post = x > 60 && x < 72 && y < 80;
                const double z = post ? 1500 : y > 60 ? std::min(30000.0 / (y - 60), 12000.0) : 12000;
                disparity_[static_cast<std::size_t>(y * width + x)] = static_cast<std::int16_t>(k / z);
            }
        }
        view_.disparity = {disparity_.data(), width, height, width};
        view_.confidence = {confidence_.data(), width, height, width};
        view_.depth_scale = {k, 0};
    }

    /// Runs the stage on the frame and returns its record.
    ScanRecord record_of(ScanStage& stage, const std::optional<SensorDirection>& up = std::nullopt) {
        memory_.assign(stage.bytes_per_frame(), std::byte{0xaa});
        stage.run({.view = view_, .memory = memory_, .f = f, .cx = 80, .cy = 60, .up = up}, serial_);
        return scan_record(memory_);
    }

    static constexpr int width = 160;
    static constexpr int height = 120;
    static constexpr double f = 100;
    static constexpr std::int64_t k = 16 * 100 * 120;
    std::vector<std::int16_t> disparity_;
    std::vector<std::uint8_t> confidence_;
    std::vector<std::byte> memory_;
    FrameView view_;
    Serial serial_;
};

TEST_F(ScanStageTest, TheRecordIsWhatTheScannerFinds) {
    const ScanOptions options;
    ScanStage stage(width, height, {}, options);
    const ScanRecord record = record_of(stage);
    ObstacleScanner scanner(width, height, options, fastest_frame_steps());
    Scan scan = scanner.empty_scan();
    scanner.scan({view_.disparity, view_.confidence}, {width, height, f, 80, 60, view_.depth_scale}, scan);
    EXPECT_TRUE(std::equal(record.sectors.begin(), record.sectors.end(), scan.sectors.begin(), scan.sectors.end()));
    EXPECT_TRUE(std::any_of(scan.sectors.begin(), scan.sectors.end(),
                            [](const ScanSector& sector) { return sector.state == SectorState::occupied; }));
    EXPECT_EQ(record.head.version, proto::scan_version);
    EXPECT_EQ(record.head.ground, GroundSource::fitted);
    EXPECT_EQ(record.head.ground_age, 0);
    EXPECT_EQ(record.head.ground_mm, std::lround(1000 * scan.ground.height_m));
    EXPECT_EQ(record.head.ground_slope_ahead, std::lround(10000 * scan.ground.slope_ahead));
    EXPECT_EQ(record.head.ground_slope_left, std::lround(10000 * scan.ground.slope_left));
    EXPECT_EQ(record.head.low_mm, 80);
    EXPECT_EQ(record.head.high_mm, 1000);
    EXPECT_EQ(record.head.min_mm, 200);
    EXPECT_EQ(record.head.max_mm, 20000);
    EXPECT_EQ(record.head.reserved, 0);
}

// As far as a signed number of 16 bits goes.
TEST_F(ScanStageTest, HeightsBeyondTheRecordAreCut) {
    ScanOptions options;
    options.high_m = 30;
    options.max_m = 65;
    ScanStage stage(width, height, {}, options);
    EXPECT_EQ(record_of(stage).head.high_mm, 30000);
    EXPECT_EQ(record_of(stage).head.max_mm, 65000);
}

TEST_F(ScanStageTest, WithGravityASteadySensorIsNeeded) {
    ScanOptions options;
    options.ground = GroundMode::gravity;
    options.imu_axes = "ahead left up";
    ScanStage stage(width, height, {}, options);
    EXPECT_EQ(stage.notice(), "");
    EXPECT_EQ(record_of(stage).head.ground, GroundSource::configured);
    EXPECT_THAT(stage.notice(), HasSubstr("obstacle scans take the configured ground"));
    const ScanRecord level = record_of(stage, SensorDirection{-0.5, 0, 9.8});
    EXPECT_EQ(level.head.ground, GroundSource::gravity);
    EXPECT_NEAR(level.head.ground_slope_ahead, 510, 1) << "the camera looks down";
    EXPECT_EQ(stage.notice(), "");
    record_of(stage, SensorDirection{9.8, 0, 0.5});
    EXPECT_NE(stage.notice(), "") << "it lies on its back";
}

TEST_F(ScanStageTest, TellsOfTheMountingThatTheFloorShows) {
    const auto after = [&](ScanStage& stage, int frames) {
        for (int i = 1; i < frames; ++i) {
            record_of(stage);
        }
        return record_of(stage).head;
    };
    constexpr int until_found = 73;  // the first frame and each eighth after it, ten in all
    ScanStage right(width, height, {}, {});
    EXPECT_EQ(after(right, until_found - 1).mounting_height_mm, 0);
    EXPECT_NEAR(record_of(right).head.mounting_height_mm, 300, 5);
    EXPECT_NEAR(record_of(right).head.mounting_pitch_cdeg, 0, 50);
    EXPECT_NEAR(record_of(right).head.mounting_roll_cdeg, 0, 50);
    EXPECT_EQ(right.notice(), "");
    ScanOptions options;
    options.camera_height_m = 1;
    ScanStage wrong(width, height, {}, options);
    EXPECT_EQ(wrong.notice(), "");
    after(wrong, until_found);
    EXPECT_THAT(wrong.notice(), HasSubstr("a height of 0.30 m"));
    options.find_mounting = true;
    ScanStage found(width, height, {}, options);
    record_of(found);
    EXPECT_THAT(found.notice(), HasSubstr("no floor has been seen"));
    EXPECT_EQ(record_of(found).sectors[0], ScanSector{});
    after(found, until_found);
    EXPECT_EQ(found.notice(), "");
    EXPECT_EQ(record_of(found).head.ground, GroundSource::fitted);
}

TEST(ScanStage, DependsOnEarlierFrames) {
    EXPECT_TRUE(ScanStage(160, 120, {}, ScanOptions{}).depends_on_earlier_frames());
}

}  // namespace
}  // namespace disparityd::test
