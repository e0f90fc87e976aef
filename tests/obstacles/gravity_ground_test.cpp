// SPDX-License-Identifier: Apache-2.0
//
// The level ground that follows from where up is.
#include "obstacles/gravity_ground.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "kernels/reference/steps.h"
#include "obstacles/obstacle_scanner.h"
#include "obstacles/scan_geometry.h"
#include "tests/kernels/support.h"
#include "tests/obstacles/floor_view.h"

namespace disparityd::test {
namespace {

constexpr double per_degree = std::numbers::pi / 180;

/// Where up is for a camera that is turned so on level ground.
CameraDirection up_of(double pitch_deg, double roll_deg) {
    ScanOptions turned;
    turned.pitch_deg = pitch_deg;
    turned.roll_deg = roll_deg;
    return scan::turn_of(turned).up;
}

TEST(SensorAxes, TurnADirectionIntoTheCamerasAxes) {
    const auto camera = scan::parse_sensor_axes("right down ahead");
    ASSERT_TRUE(camera);
    EXPECT_EQ(camera->turned({1, 2, 2}), (CameraDirection{1 / 3.0, 2 / 3.0, 2 / 3.0}));
    const auto robot = scan::parse_sensor_axes("ahead left up");
    ASSERT_TRUE(robot);
    EXPECT_EQ(robot->turned({1, 2, -2}), (CameraDirection{-2 / 3.0, 2 / 3.0, 1 / 3.0}));
}

TEST(SensorAxes, AreThreeOfARightHandedSystem) {
    const std::array<std::string, 6> words{"right", "left", "up", "down", "ahead", "back"};
    int allowed = 0;
    for (const std::string& x : words) {
        for (const std::string& y : words) {
            for (const std::string& z : words) {
                allowed += scan::parse_sensor_axes(x + ' ' + y + ' ' + z) ? 1 : 0;
            }
        }
    }
    EXPECT_EQ(allowed, 24) << "a cube has so many rotations";
    for (const char* wrong : {"", "up", "ahead left", "ahead left up ", "ahead  left up", "ahead left up down",
                              "ahead left left", "ahead left right", "forward left up", "left ahead up"}) {
        EXPECT_FALSE(scan::parse_sensor_axes(wrong)) << wrong;
    }
}

TEST(LevelGround, IsThePlaneAtRightAnglesToGravity) {
    ScanOptions options;
    options.camera_height_m = 0.5;
    options.pitch_deg = 10;
    const auto level = scan::level_ground(up_of(10, 0), options);
    ASSERT_TRUE(level);
    EXPECT_NEAR(level->height_m, 0, 1e-9);
    EXPECT_NEAR(level->slope_ahead, 0, 1e-9);
    EXPECT_NEAR(level->slope_left, 0, 1e-9);

    // The robot looks down by 5 degrees more: in its frame the ground rises ahead.
    const auto nose_down = scan::level_ground(up_of(15, 0), options);
    ASSERT_TRUE(nose_down);
    EXPECT_NEAR(nose_down->slope_ahead, std::tan(5 * per_degree), 1e-9);
    EXPECT_NEAR(nose_down->slope_left, 0, 1e-9);

    // Its right side is lower by 4 degrees: the ground rises to the right.
    options.pitch_deg = 0;
    const auto rolled = scan::level_ground(up_of(0, 4), options);
    ASSERT_TRUE(rolled);
    EXPECT_NEAR(rolled->slope_left, -std::tan(4 * per_degree), 1e-9);
    EXPECT_NEAR(rolled->slope_ahead, 0, 1e-9);
}

TEST(LevelGround, LiesTheCamerasHeightBelowIt) {
    Random random(3);
    for (int round = 0; round < 200; ++round) {
        ScanOptions options;
        options.camera_height_m = pick(random, 20, 200) / 100.0;
        options.pitch_deg = pick(random, -30, 30);
        options.roll_deg = pick(random, -20, 20);
        options.yaw_deg = pick(random, -180, 180);
        const auto level = scan::level_ground(
            up_of(options.pitch_deg + pick(random, -15, 15), options.roll_deg + pick(random, -15, 15)), options);
        ASSERT_TRUE(level);
        const double normal =
            std::sqrt(1 + level->slope_ahead * level->slope_ahead + level->slope_left * level->slope_left);
        EXPECT_NEAR((options.camera_height_m - level->height_m) / normal, options.camera_height_m, 1e-9);
    }
}

TEST(LevelGround, ARobotThatLiesOnItsSideHasNone) {
    EXPECT_TRUE(scan::level_ground(up_of(29, 0), {}));
    EXPECT_FALSE(scan::level_ground(up_of(31, 0), {}));
    EXPECT_FALSE(scan::level_ground(up_of(0, -31), {}));
    EXPECT_FALSE(scan::level_ground(up_of(180, 0), {}));
    EXPECT_FALSE(scan::level_ground({NAN, NAN, NAN}, {}));
}

TEST(ObstacleScannerWithGravity, AFloorThatTheRobotLeansTowardsIsFree) {
    constexpr int width = 320;
    constexpr int height = 240;
    const scan::Camera camera{width, height, 200, 159.5, 119.5, {16L * 200 * 120, 0}};
    ScanOptions leaning;
    leaning.pitch_deg = 6;  // what the camera really looks down, and nobody has configured
    const scan::Rays rays = scan::make_rays(camera, leaning);
    std::vector<std::int16_t> disparity(width * height);
    std::vector<std::uint8_t> confidence(width * height, 250);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double up = rays.up(x, y);
            const double depth = up < 0 ? std::min(0.3 / -up, 12.0) : 12.0;
            disparity[static_cast<std::size_t>(y * width + x)] =
                static_cast<std::int16_t>(std::lround(16 * 200 * 0.12 / depth));
        }
    }
    const auto nearest = [&](GroundMode ground, const std::optional<CameraDirection>& up) {
        ScanOptions options;
        options.ground = ground;
        options.imu_axes = "right down ahead";
        options.max_m = 8;
        ObstacleScanner scanner(width, height, options, reference::steps.frame);
        Scan scan = scanner.empty_scan();
        scanner.scan({{disparity.data(), width, height, width}, {confidence.data(), width, height, width}}, camera,
                     scan, up);
        EXPECT_EQ(scan.ground_source, up ? GroundSource::gravity : GroundSource::configured);
        int nearest_mm = 99999;
        for (const ScanSector& sector : scan.sectors) {
            nearest_mm =
                sector.state == SectorState::occupied ? std::min<int>(nearest_mm, sector.distance_mm) : nearest_mm;
        }
        return nearest_mm;
    };
    EXPECT_LT(nearest(GroundMode::configured, std::nullopt), 3000) << "the floor rises into the band";
    EXPECT_EQ(nearest(GroundMode::gravity, up_of(6, 0)), 99999);
    EXPECT_EQ(nearest(GroundMode::gravity, std::nullopt), nearest(GroundMode::configured, std::nullopt))
        << "without samples it is the configured ground";
}

/// What flies 1.5 m above a floor, with a wall 8 m ahead, and looks down by 15 degrees.
TEST(LevelGround, ABandAroundTheCameraStaysLevelAtAPitchOf15Degrees) {
    const FloorView view = FloorView({1.5, 15, 0}).floor().wall(8);
    ScanOptions options;
    options.camera_height_m = 0;
    options.low_m = -0.4;
    options.high_m = 0.4;
    options.imu_axes = "ahead left up";
    const auto ahead = [&](GroundMode ground) {
        options.ground = ground;
        ObstacleScanner scanner(FloorView::width, FloorView::height, options, reference::steps.frame);
        Scan scan = scanner.empty_scan();
        scanner.scan(view.pixels(), FloorView::camera(), scan, up_of(15, 0));
        return scan.sectors[scan.sectors.size() / 2];
    };
    const ScanSector level = ahead(GroundMode::gravity);
    ASSERT_EQ(level.state, SectorState::occupied);
    EXPECT_NEAR(level.distance_mm, 8000 * std::cos(15 * per_degree), 400);
    EXPECT_GT(level.free_mm, 2000) << "the floor is no obstacle";
    EXPECT_LT(ahead(GroundMode::configured).distance_mm, 6000) << "the floor in the way of a band that is not level";
}

}  // namespace
}  // namespace disparityd::test
