// SPDX-License-Identifier: Apache-2.0
//
// Whole scans of disparity images that are computed from planes and boxes, without any matching.
#include "obstacles/obstacle_scanner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kernels/reference/steps.h"
#include "tests/kernels/support.h"

namespace disparityd::test {
namespace {

constexpr int width = 320;
constexpr int height = 240;
constexpr double f = 200;
constexpr double baseline_mm = 120;

scan::Camera camera() {
    return {width, height, f, (width - 1) / 2.0, (height - 1) / 2.0, {std::lround(16 * f * baseline_mm), 0}};
}

/// An image whose pixels know their depth; without one they are rejected.
struct Frame {
    std::vector<std::int16_t> disparity = std::vector<std::int16_t>(width * height, -16);
    std::vector<std::uint8_t> confidence = std::vector<std::uint8_t>(width * height, 0);

    void set(int x, int y, double depth_m, std::uint8_t sure = 250) {
        const auto i = static_cast<std::size_t>(y * width + x);
        disparity[i] = static_cast<std::int16_t>(std::lround(16 * f * baseline_mm / (1000 * depth_m)));
        confidence[i] = sure;
    }
    void reject(int x, int y) {
        disparity[static_cast<std::size_t>(y * width + x)] = -16;
        confidence[static_cast<std::size_t>(y * width + x)] = 0;
    }
    scan::Pixels pixels() const {
        return {{disparity.data(), width, height, width}, {confidence.data(), width, height, width}};
    }
};

/// The rays of pixel (x, y): what it moves left and down per metre of depth.
double left_of(int x) {
    return -(x - (width - 1) / 2.0) / f;
}
double down_of(int y) {
    return (y - (height - 1) / 2.0) / f;
}

/// A floor `camera_m` below the camera that rises by `slope` ahead, and a wall `wall_m` ahead; no wall where it is 0.
Frame room(double camera_m, double wall_m, double slope = 0) {
    Frame frame;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double fall = down_of(y) + slope;
            const double floor = fall > 0 ? camera_m / fall : 1e9;
            if (wall_m > 0 || floor < 15) {
                frame.set(x, y, wall_m > 0 ? std::min(floor, wall_m) : floor);
            }
        }
    }
    return frame;
}

/// Puts an upright board into a frame: nearer pixels stay.
void add_board(Frame& frame, double ahead, double left_from, double left_to, double up_from, double up_to,
               double camera_m, std::uint8_t sure = 250) {
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double left = left_of(x) * ahead;
            const double up = camera_m - down_of(y) * ahead;
            if (left >= left_from && left <= left_to && up >= up_from && up <= up_to) {
                frame.set(x, y, ahead, sure);
            }
        }
    }
}

ScanOptions usual() {
    ScanOptions options;
    options.sectors = 31;
    options.camera_height_m = 0.3;
    options.high_m = 0.5;
    options.ground = GroundMode::configured;
    return options;
}

Scan scanned(const Frame& frame, const ScanOptions& options, const scan::Camera& seen_by = camera()) {
    ObstacleScanner scanner(width, height, options, reference::steps.frame);
    Scan scan = scanner.empty_scan();
    scanner.scan(frame.pixels(), seen_by, scan);
    return scan;
}

const ScanSector& ahead(const Scan& scan) {
    return scan.sectors[scan.sectors.size() / 2];
}

TEST(ObstacleScanner, EmptyFloorIsFreeUpToTheWall) {
    const Scan scan = scanned(room(0.3, 5), usual());
    for (const ScanSector& sector : scan.sectors) {
        EXPECT_EQ(sector.state, SectorState::occupied);
    }
    EXPECT_NEAR(ahead(scan).distance_mm, 5000, 150);
    EXPECT_NEAR(ahead(scan).sigma_mm, 5000.0 * 5000 * 0.25 / (f * baseline_mm), 20);
    // Half of the smallest obstacle's pixels are needed: 0.1 m has 8 of them up to 3.6 m.
    EXPECT_GT(ahead(scan).free_mm, 2500);
    EXPECT_LE(ahead(scan).free_mm, ahead(scan).distance_mm);
    EXPECT_LT(ahead(scan).from_cdeg, 0);
    EXPECT_GT(ahead(scan).to_cdeg, 0);
}

TEST(ObstacleScanner, WallAtAnAngleHasTheHorizontalDistance) {
    const Scan scan = scanned(room(0.3, 3), usual());
    const ScanSector& right = scan.sectors.front();
    const double bearing = (right.from_cdeg + right.to_cdeg) / 200.0 * 3.14159265 / 180;
    EXPECT_NEAR(right.distance_mm, 3000 / std::cos(bearing), 150);
}

TEST(ObstacleScanner, PoleOfThreePixelsCounts) {
    Frame frame = room(0.3, 6);
    add_board(frame, 2, -0.015, 0.015, 0, 1, 0.3);
    const Scan scan = scanned(frame, usual());
    EXPECT_EQ(ahead(scan).state, SectorState::occupied);
    EXPECT_NEAR(ahead(scan).distance_mm, 2000, 60);
    EXPECT_NEAR(ahead(scan).high_mm, 500, 60) << "the band ends there";
    EXPECT_LT(ahead(scan).low_mm, 200);
    EXPECT_EQ(ahead(scan).confidence, 250);
}

TEST(ObstacleScanner, PoleOnTheEdgeOfTwoSectorsCounts) {
    ScanOptions options = usual();
    options.sectors = 30;  // an edge straight ahead
    Frame frame = room(0.3, 6);
    // 4 x 11 px, half of them in each sector; the smallest obstacle has 100, of which 30 are needed.
    add_board(frame, 2, -0.02, 0.02, 0.12, 0.23, 0.3);
    const Scan scan = scanned(frame, options);
    EXPECT_NEAR(scan.sectors[14].distance_mm, 2000, 60);
    EXPECT_NEAR(scan.sectors[15].distance_mm, 2000, 60);
}

TEST(ObstacleScanner, FlyPixelDoesNotCount) {
    Frame frame = room(0.3, 6);
    for (int y = 110; y < 112; ++y) {
        for (int x = 158; x < 161; ++x) {
            frame.set(x, y, 0.5);
        }
    }
    EXPECT_GT(ahead(scanned(frame, usual())).distance_mm, 5500);
}

TEST(ObstacleScanner, GroundAndOverheadDoNotCount) {
    Frame frame = room(0.3, 6);
    add_board(frame, 1.5, -1, 1, 0, 0.06, 0.3);    // lower than low_m
    add_board(frame, 1.5, -1, 1, 0.55, 0.9, 0.3);  // higher than high_m
    EXPECT_GT(ahead(scanned(frame, usual())).distance_mm, 5500);
    add_board(frame, 1.5, -1, 1, 0.2, 0.4, 0.3);
    EXPECT_NEAR(ahead(scanned(frame, usual())).distance_mm, 1500, 50);
}

TEST(ObstacleScanner, NothingSeenIsUnknown) {
    for (const ScanSector& sector : scanned(Frame(), usual()).sectors) {
        EXPECT_EQ(sector.state, SectorState::unknown);
        EXPECT_LE(sector.free_mm, 200);
    }
}

TEST(ObstacleScanner, DisparityZeroEverywhereIsUnknown) {
    // What matching makes of an image without texture, at the highest confidence.
    Frame frame;
    std::fill(frame.disparity.begin(), frame.disparity.end(), std::int16_t{0});
    std::fill(frame.confidence.begin(), frame.confidence.end(), std::uint8_t{255});
    for (const ScanSector& sector : scanned(frame, usual()).sectors) {
        EXPECT_EQ(sector.state, SectorState::unknown);
    }
}

TEST(ObstacleScanner, WithoutACalibrationAllIsUnknown) {
    scan::Camera unknown = camera();
    unknown.f = 0;
    const Scan scan = scanned(room(0.3, 2), usual(), unknown);
    EXPECT_EQ(scan.sectors.size(), 31U);
    for (const ScanSector& sector : scan.sectors) {
        EXPECT_EQ(sector.state, SectorState::unknown);
        EXPECT_EQ(sector.free_mm, 0);
    }
}

TEST(ObstacleScanner, FarAwayIsFreeButNotAnObstacle) {
    // 20 m: d = 1.2 px, one sigma is 4 m. Nobody knows how far, but nothing is near.
    const Scan scan = scanned(room(0.3, 20), usual());
    EXPECT_EQ(ahead(scan).state, SectorState::free);
    EXPECT_GT(ahead(scan).free_mm, 2500);
    EXPECT_EQ(ahead(scan).distance_mm, 0);
}

TEST(ObstacleScanner, AHoleLimitsWhatIsFree) {
    Frame frame = room(0.3, 6);
    // A board of 0.3 x 0.3 m at 1.5 m of which nothing was measured: 40 px. A smallest obstacle of 0.1 m fills it from
    // 0.5 m on.
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            if (std::abs(left_of(x) * 1.5) < 0.15 && std::abs(0.3 - down_of(y) * 1.5 - 0.25) < 0.15) {
                frame.reject(x, y);
            }
        }
    }
    const Scan scan = scanned(frame, usual());
    EXPECT_LT(ahead(scan).free_mm, 700);
    EXPECT_GE(ahead(scan).free_mm, 350);
    EXPECT_GT(scan.sectors.front().free_mm, 2500) << "the hole is not there";
    // What is larger cannot hide there so near.
    ScanOptions large = usual();
    large.object_m = 0.25;
    EXPECT_GT(ahead(scanned(frame, large)).free_mm, 1000);
}

TEST(ObstacleScanner, UnsurePixelsAreNeitherObstacleNorFree) {
    Frame frame = room(0.3, 6);
    add_board(frame, 1.5, -0.2, 0.2, 0.1, 0.5, 0.3, 20);
    const Scan scan = scanned(frame, usual());
    EXPECT_EQ(ahead(scan).distance_mm, 0) << "the wall is behind it";
    EXPECT_LT(ahead(scan).free_mm, 1000);
}

TEST(ObstacleScanner, WhatIsNearerThanTheLeastDistanceIsUnknown) {
    ScanOptions options = usual();
    options.min_m = 0.8;
    Frame frame = room(0.3, 6);
    add_board(frame, 0.5, -1, 1, 0, 1, 0.3);
    EXPECT_EQ(ahead(scanned(frame, options)).state, SectorState::unknown);
}

TEST(ObstacleScanner, SlopeIsFitted) {
    ScanOptions options = usual();
    options.ground = GroundMode::fitted;
    for (const double slope : {-0.15, -0.05, 0.0, 0.05, 0.15}) {
        const Scan scan = scanned(room(0.3, 4, slope), options);
        EXPECT_EQ(scan.ground_source, GroundSource::fitted);
        EXPECT_NEAR(scan.ground.slope_ahead, slope, 0.01);
        EXPECT_NEAR(scan.ground.slope_left, 0, 0.01);
        EXPECT_NEAR(scan.ground.height_m, 0, 0.01);
    }
    // Without the fit a ramp is an obstacle.
    EXPECT_LT(ahead(scanned(room(0.3, 4, 0.15), usual())).distance_mm, 2500);
}

TEST(ObstacleScanner, GroundIsHeldForAWhile) {
    ScanOptions options = usual();
    options.ground = GroundMode::fitted;
    ObstacleScanner scanner(width, height, options, reference::steps.frame);
    Scan scan = scanner.empty_scan();
    const Frame ramp = room(0.3, 4, 0.1);
    Frame wall;
    add_board(wall, 1, -9, 9, -9, 9, 0.3);
    scanner.scan(ramp.pixels(), camera(), scan);
    const GroundPlane fitted = scan.ground;
    for (int i = 1; i <= 30; ++i) {
        scanner.scan(wall.pixels(), camera(), scan);
        EXPECT_EQ(scan.ground_source, GroundSource::held);
        EXPECT_EQ(scan.ground_age, i);
        EXPECT_EQ(scan.ground, fitted);
    }
    scanner.scan(wall.pixels(), camera(), scan);
    EXPECT_EQ(scan.ground_source, GroundSource::configured);
    EXPECT_EQ(scan.ground, GroundPlane{});
}

TEST(ObstacleScanner, SameFramesGiveTheSameScans) {
    ScanOptions options = usual();
    options.ground = GroundMode::fitted;
    EXPECT_EQ(scanned(room(0.3, 4, 0.1), options).sectors, scanned(room(0.3, 4, 0.1), options).sectors);
}

TEST(ObstacleScanner, FollowsAChangeOfTheCalibration) {
    ObstacleScanner scanner(width, height, usual(), reference::steps.frame);
    Scan scan = scanner.empty_scan();
    const Frame frame = room(0.3, 4);
    scanner.scan(frame.pixels(), camera(), scan);
    scan::Camera other = camera();
    other.scale.offset16 = 8;
    scanner.scan(frame.pixels(), other, scan);
    EXPECT_EQ(scan.sectors, scanned(frame, usual(), other).sectors);
}

TEST(ObstacleScanner, BadOptionsAreRefusedInOneLine) {
    const auto refused = [](const std::function<void(ScanOptions&)>& change) {
        ScanOptions options;
        change(options);
        try {
            ObstacleScanner(width, height, options, reference::steps.frame);
        } catch (const std::invalid_argument& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_EQ(refused([](ScanOptions& o) { o.sectors = 0; }), "sectors = 0: allowed is 1 to 360");
    EXPECT_EQ(refused([](ScanOptions& o) { o.pitch_deg = NAN; }), "pitch_deg = nan: allowed is -45 to 45");
    EXPECT_EQ(refused([](ScanOptions& o) { o.high_m = 0.05; }), "high_m = 0.05: allowed is more than low_m, 0.08");
    EXPECT_EQ(refused([](ScanOptions& o) { o.from_deg = 10; }),
              "to_deg = 0: allowed is more than from_deg, 10, or 0 for both: the field of view");
    EXPECT_EQ(refused([](ScanOptions& o) { o.camera_height_m = 0.09; }),
              "camera_height_m = 0.09: allowed is at least 0.02 more than low_m, 0.08");
    EXPECT_EQ(refused([](ScanOptions& o) { o.camera_left_m = 11; }), "camera_left_m = 11: allowed is -10 to 10");
    EXPECT_THAT(
        refused([](ScanOptions& o) { o.ground = GroundMode::gravity; }),
        testing::AllOf(testing::StartsWith("imu_axes = \"\": allowed is where the sensor's x, y and z axes point"),
                       testing::EndsWith("; ground = \"gravity\" needs it")));
    EXPECT_THAT(refused([](ScanOptions& o) { o.imu_axes = "x y z"; }), testing::StartsWith("imu_axes = \"x y z\""));
    EXPECT_THAT(refused([](ScanOptions& o) {
                    o.ground = GroundMode::autopilot;
                    o.find_mounting = true;
                }),
                testing::StartsWith("find_mounting = true: allowed is false with ground = \"autopilot\""));
    EXPECT_EQ(refused([](ScanOptions& o) { o.min_m = 30; }), "max_m = 20: allowed is more than min_m, 30");
}

/// Whatever comes in, a scan keeps its promises.
void expect_valid(const Scan& scan, const ScanOptions& options) {
    const int least = static_cast<int>(std::floor(1000 * options.min_m));
    for (const ScanSector& sector : scan.sectors) {
        switch (sector.state) {
            case SectorState::unknown:
                EXPECT_LE(sector.free_mm, least + 1);
                EXPECT_EQ(sector.distance_mm, 0);
                break;
            case SectorState::free:
                EXPECT_GE(sector.free_mm, least);
                EXPECT_LE(sector.free_mm, 1000 * options.max_m + 1);
                EXPECT_EQ(sector.distance_mm, 0);
                break;
            case SectorState::occupied:
                EXPECT_GE(sector.distance_mm, least);
                EXPECT_LE(sector.distance_mm, 1000 * options.max_m + 1);
                EXPECT_LE(sector.free_mm, sector.distance_mm);
                EXPECT_GT(sector.pixels, 0);
                break;
            default: ADD_FAILURE() << "state " << static_cast<int>(sector.state);
        }
        EXPECT_LE(sector.from_cdeg, sector.to_cdeg);
    }
}

TEST(ObstacleScanner, AnyInputGivesAValidScan) {
    Random random(7);
    for (int round = 0; round < 150; ++round) {
        const int columns = pick(random, 1, 150);
        const int rows = pick(random, 1, 90);
        ScanOptions options;
        options.sectors = pick(random, 1, 360);
        const std::array modes{GroundMode::fitted, GroundMode::configured, GroundMode::gravity, GroundMode::autopilot};
        options.ground = modes.at(static_cast<std::size_t>(round) % modes.size());
        options.imu_axes = "ahead left up";
        options.low_m = pick(random, -300, 300) / 100.0;
        options.high_m = options.low_m + pick(random, 1, 500) / 100.0;
        options.camera_height_m = options.low_m + pick(random, 2, 600) / 100.0;
        options.pitch_deg = pick(random, -45, 45);
        options.roll_deg = pick(random, -45, 45);
        options.yaw_deg = pick(random, -180, 180);
        options.camera_ahead_m = pick(random, 0, 1) * pick(random, -1000, 1000) / 100.0;
        options.camera_left_m = pick(random, 0, 1) * pick(random, -1000, 1000) / 100.0;
        options.from_deg = pick(random, 0, 1) * pick(random, -180, 90);
        options.to_deg = options.from_deg == 0 ? 0 : options.from_deg + pick(random, 1, 80);
        options.min_m = pick(random, 1, 200) / 100.0;
        options.max_m = options.min_m + pick(random, 1, 60);
        options.object_m = pick(random, 1, 1000) / 100.0;
        options.max_error_m = pick(random, 1, 60000) / 1000.0;
        options.subpixel_error_px = pick(random, 1, 400) / 100.0;
        options.min_confidence = pick(random, 1, 255);
        const Image<std::int16_t> disparity = [&] {
            Image<std::int16_t> image(columns, rows);
            const int most = pick(random, 1, 32767);
            for (std::int16_t& value : image.pixels()) {
                value = static_cast<std::int16_t>(pick(random, pick(random, 0, 3) == 0 ? -32768 : 0, most));
            }
            return image;
        }();
        const Image<std::uint8_t> confidence = noise(random, columns, rows);
        ObstacleScanner scanner(columns, rows, options, fastest_frame_steps());
        Scan scan = scanner.empty_scan();
        for (int frame = 0; frame < 2; ++frame) {
            const double focal = pick(random, 1, 3000) / (frame == 0 ? 1.0 : 100.0);
            scanner.scan({disparity.plane(), confidence.plane()},
                         {columns,
                          rows,
                          focal,
                          1.0 * pick(random, -50, 200),
                          1.0 * pick(random, -50, 200),
                          {std::int64_t{1} << pick(random, 0, 40), pick(random, -40000, 40000)}},
                         scan, CameraDirection{pick(random, -10, 10) / 20.0, -0.8, pick(random, -10, 10) / 20.0});
            expect_valid(scan, options);
        }
    }
}

}  // namespace
}  // namespace disparityd::test
