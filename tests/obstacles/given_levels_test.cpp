// SPDX-License-Identifier: Apache-2.0
//
// Levels that an autopilot gives, and the scans that follow from them.
#include "obstacles/given_levels.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "obstacles/gravity_ground.h"
#include "obstacles/scan_geometry.h"
#include "obstacles/scan_stage.h"
#include "tests/obstacles/floor_view.h"

namespace disparityd::test {
namespace {

using scan::GivenLevels;
using scan::RobotUp;
using testing::HasSubstr;

constexpr std::int64_t ms = 1'000'000;

/// Where up is for what looks down by so many degrees.
RobotUp nose_down(double degrees) {
    return {-std::sin(degrees * scan::per_degree), 0, std::cos(degrees * scan::per_degree)};
}

TEST(GivenLevels, AreInterpolatedAtTheTimeOfTheFrame) {
    GivenLevels levels;
    EXPECT_FALSE(levels.up_at(0));
    EXPECT_FALSE(levels.newest_ns());
    levels.add(1000 * ms, nose_down(0));
    levels.add(1100 * ms, nose_down(10));
    const auto between = levels.up_at(1050 * ms);
    ASSERT_TRUE(between);
    EXPECT_NEAR(between->ahead, nose_down(5).ahead, 1e-9);
    EXPECT_NEAR(between->up, nose_down(5).up, 1e-9);
    EXPECT_EQ(levels.up_at(1000 * ms), nose_down(0));
    EXPECT_EQ(levels.newest_ns(), 1100 * ms);
}

TEST(GivenLevels, HoldForAFifthOfASecondAndNoLonger) {
    GivenLevels levels;
    levels.add(1000 * ms, nose_down(3));
    EXPECT_EQ(levels.up_at(1200 * ms), nose_down(3));
    EXPECT_FALSE(levels.up_at(1200 * ms + 1));
    EXPECT_EQ(levels.up_at(800 * ms), nose_down(3));
    EXPECT_FALSE(levels.up_at(800 * ms - 1));
    levels.add(1450 * ms, nose_down(9));
    EXPECT_EQ(levels.up_at(1150 * ms), nose_down(3)) << "the next one is too far away to say anything";
    EXPECT_EQ(levels.up_at(1300 * ms), nose_down(9));
    EXPECT_FALSE(levels.up_at(1225 * ms));
}

TEST(GivenLevels, OneThatIsNotLaterIsLeftOut) {
    GivenLevels levels;
    levels.add(1000 * ms, nose_down(3));
    levels.add(1000 * ms, nose_down(20));
    levels.add(900 * ms, nose_down(20));
    EXPECT_EQ(levels.up_at(1000 * ms), nose_down(3));
    EXPECT_EQ(levels.up_at(900 * ms), nose_down(3));
}

TEST(GivenLevels, TheOldestGoFirst) {
    GivenLevels levels;
    for (int i = 0; i < 1000; ++i) {
        levels.add(i * ms, nose_down(i % 2 == 0 ? 1 : 2));
    }
    EXPECT_EQ(levels.up_at(998 * ms), nose_down(1));
    EXPECT_EQ(levels.up_at(999 * ms), nose_down(2));
    EXPECT_EQ(levels.up_at(744 * ms), nose_down(1)) << "256 are kept";
    EXPECT_EQ(levels.up_at(743 * ms), nose_down(1)) << "the oldest one that is kept";
    EXPECT_FALSE(levels.up_at(543 * ms));
}

TEST(GivenLevels, AreDirectionsOnly) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinite = std::numeric_limits<double>::infinity();
    for (const RobotUp& wrong :
         {RobotUp{nan, 0, 1}, RobotUp{0, nan, 1}, RobotUp{0, 0, nan}, RobotUp{infinite, 0, 1},
          RobotUp{infinite, nan, 1}, RobotUp{0, 0, 0}, RobotUp{0, 0, 2}, RobotUp{1e300, 1e300, 1}}) {
        EXPECT_FALSE(scan::checked_up(wrong)) << wrong.ahead << ' ' << wrong.left << ' ' << wrong.up;
    }
    const auto good = scan::checked_up({0, 0, 1.05});
    ASSERT_TRUE(good);
    EXPECT_EQ(good->up, 1);
    // Half way between a direction and its opposite there is none.
    GivenLevels levels;
    levels.add(0, {0, 0, 1});
    levels.add(100 * ms, {0, 0, -1});
    const auto none = levels.up_at(50 * ms);
    EXPECT_FALSE(none && scan::level_ground(scan::along_camera(*none, {}), {}));
}

TEST(AlongCamera, IsTheRobotsDirectionSeenFromItsMounting) {
    ScanOptions options;
    options.pitch_deg = 20;
    options.roll_deg = -7;
    options.yaw_deg = 130;
    const auto level = scan::level_ground(scan::along_camera({0, 0, 1}, options), options);
    ASSERT_TRUE(level);
    EXPECT_NEAR(level->slope_ahead, 0, 1e-9) << "a robot that stands upright, however the camera is turned";
    EXPECT_NEAR(level->slope_left, 0, 1e-9);
    const auto down = scan::level_ground(scan::along_camera(nose_down(5), options), options);
    ASSERT_TRUE(down);
    EXPECT_NEAR(down->slope_ahead, std::tan(5 * scan::per_degree), 1e-9) << "the ground rises ahead";
    const auto right_side_down = scan::level_ground(
        scan::along_camera({0, std::sin(4 * scan::per_degree), std::cos(4 * scan::per_degree)}, options), options);
    ASSERT_TRUE(right_side_down);
    EXPECT_NEAR(right_side_down->slope_left, -std::tan(4 * scan::per_degree), 1e-9) << "it rises to the right";
}

/// What flies 1.5 m above a floor, with a wall 8 m ahead, and looks down by 15 degrees.
class FlyingScanTest : public testing::Test {
protected:
    FlyingScanTest() {
        options_.camera_height_m = 0;
        options_.low_m = -0.4;
        options_.high_m = 0.4;
        options_.ground = GroundMode::autopilot;
    }

    ScanRecord scan_at(ScanStage& stage, std::int64_t monotonic_ns) {
        memory_.assign(stage.bytes_per_frame(), std::byte{0xaa});
        const scan::Camera camera = FloorView::camera();
        stage.run({.view = view_.frame(),
                   .memory = memory_,
                   .monotonic_ns = monotonic_ns,
                   .f = camera.f,
                   .cx = camera.cx,
                   .cy = camera.cy,
                   .up = std::nullopt},
                  serial_);
        return scan_record(memory_);
    }
    ScanStage stage(const GivenLevels* levels) const {
        return {FloorView::width, FloorView::height, {}, options_, levels};
    }
    static const ScanSector& ahead(const ScanRecord& record) { return record.sectors[record.sectors.size() / 2]; }
    static bool knows_nothing(const ScanRecord& record) {
        return record.head.ground == GroundSource::configured &&
               std::all_of(record.sectors.begin(), record.sectors.end(),
                           [](const ScanSector& sector) { return sector == ScanSector{}; });
    }

    ScanOptions options_;
    GivenLevels levels_;

private:
    FloorView view_ = FloorView({1.5, 15, 0}).floor().wall(8);
    std::vector<std::byte> memory_;
    Serial serial_;
};

TEST_F(FlyingScanTest, AtAPitchOf15DegreesTheFloorIsNoObstacleAndTheWallIsOne) {
    ScanStage stage = this->stage(&levels_);
    levels_.add(1000 * ms, nose_down(14));
    levels_.add(1040 * ms, nose_down(16));
    const ScanRecord record = scan_at(stage, 1020 * ms);
    EXPECT_EQ(record.head.ground, GroundSource::autopilot);
    EXPECT_NEAR(record.head.ground_slope_ahead, 10000 * std::tan(15 * scan::per_degree), 2);
    ASSERT_EQ(ahead(record).state, SectorState::occupied);
    EXPECT_NEAR(ahead(record).distance_mm, 8000 * std::cos(15 * scan::per_degree), 400);
    EXPECT_GT(ahead(record).free_mm, 2000) << "the floor is no obstacle";
    EXPECT_EQ(stage.notice(), "");
    GivenLevels wrong;
    wrong.add(1020 * ms, nose_down(0));
    ScanStage misled = this->stage(&wrong);
    EXPECT_LT(ahead(scan_at(misled, 1020 * ms)).distance_mm, 6000)
        << "the floor in the way of a band that is not level";
}

TEST_F(FlyingScanTest, WithoutAFreshLevelNothingIsKnown) {
    ScanStage stage = this->stage(&levels_);
    EXPECT_TRUE(knows_nothing(scan_at(stage, 1000 * ms)));
    EXPECT_THAT(stage.notice(), HasSubstr("obstacle scans know nothing: no autopilot has told its attitude"));
    levels_.add(1000 * ms, nose_down(15));
    EXPECT_EQ(scan_at(stage, 1200 * ms).head.ground, GroundSource::autopilot);
    EXPECT_EQ(stage.notice(), "");
    EXPECT_TRUE(knows_nothing(scan_at(stage, 1201 * ms)));
    levels_.add(1300 * ms, nose_down(31));
    EXPECT_TRUE(knows_nothing(scan_at(stage, 1300 * ms))) << "further than a band is kept level";
    ScanStage replayed = this->stage(nullptr);
    EXPECT_TRUE(knows_nothing(scan_at(replayed, 1000 * ms)));
}

TEST_F(FlyingScanTest, OnlyTheConfiguredGroundIsTaken) {
    levels_.add(1000 * ms, nose_down(15));
    options_.ground = GroundMode::gravity;
    options_.imu_axes = "ahead left up";
    ScanStage inertial = this->stage(&levels_);
    EXPECT_EQ(scan_at(inertial, 1000 * ms).head.ground, GroundSource::configured)
        << "an autopilot does not stand in for the sensor";
}

}  // namespace
}  // namespace disparityd::test
