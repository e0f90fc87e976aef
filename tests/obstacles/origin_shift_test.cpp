// SPDX-License-Identifier: Apache-2.0
//
// Scans around the robot's origin, which the camera is not above, against points that are measured from there.
#include "obstacles/origin_shift.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "kernels/reference/steps.h"
#include "obstacles/obstacle_scanner.h"
#include "tests/kernels/support.h"

namespace disparityd::test::origin_shift {
namespace {

constexpr int width = 320;
constexpr int height = 240;
constexpr double f = 160;
constexpr double baseline_mm = 120;
constexpr double per_degree = std::numbers::pi / 180;

/// An upright round post, in the robot's frame.
struct Post {
    double ahead = 0;
    double left = 0;
    double radius = 0.1;

    double distance() const { return std::hypot(ahead, left); }
    double bearing() const { return std::atan2(left, ahead) / per_degree; }
};

ScanOptions usual(double camera_ahead, double camera_left) {
    ScanOptions options;
    options.sectors = 45;
    options.ground = GroundMode::configured;
    options.camera_ahead_m = camera_ahead;
    options.camera_left_m = camera_left;
    options.max_m = 10;
    return options;
}

/// What a camera 0.3 m above a floor sees of posts, up to a wall 12 m ahead of it, and its scan.
Scan scanned(const std::vector<Post>& posts, const ScanOptions& options) {
    std::vector<std::int16_t> disparity(width * height);
    const std::vector<std::uint8_t> confidence(width * height, 250);
    const double yaw = options.yaw_deg * per_degree;
    for (int x = 0; x < width; ++x) {
        const double side = -(x - (width - 1) / 2.0) / f;
        const double ahead = std::cos(yaw) - side * std::sin(yaw);
        const double left = std::sin(yaw) + side * std::cos(yaw);
        double nearest = 12;
        for (const Post& post : posts) {
            const double to_ahead = post.ahead - options.camera_ahead_m;
            const double to_left = post.left - options.camera_left_m;
            const double square = ahead * ahead + left * left;
            const double along = (to_ahead * ahead + to_left * left) / square;
            const double root =
                along * along - (to_ahead * to_ahead + to_left * to_left - post.radius * post.radius) / square;
            nearest = root > 0 && along > 0 ? std::min(nearest, along - std::sqrt(root)) : nearest;
        }
        for (int y = 0; y < height; ++y) {
            const double down = (y - (height - 1) / 2.0) / f;
            const double depth = down > 0 ? std::min(nearest, 0.3 / down) : nearest;
            disparity[static_cast<std::size_t>(y * width + x)] =
                static_cast<std::int16_t>(std::lround(16 * f * baseline_mm / (1000 * depth)));
        }
    }
    const scan::Camera camera{
        width, height, f, (width - 1) / 2.0, (height - 1) / 2.0, {std::lround(16 * f * baseline_mm), 0}};
    ObstacleScanner scanner(width, height, options, reference::steps.frame);
    Scan scan = scanner.empty_scan();
    scanner.scan({{disparity.data(), width, height, width}, {confidence.data(), width, height, width}}, camera, scan);
    return scan;
}

const ScanSector* sector_at(const Scan& scan, double bearing_deg) {
    for (const ScanSector& sector : scan.sectors) {
        if (bearing_deg >= sector.from_cdeg / 100.0 && bearing_deg < sector.to_cdeg / 100.0) {
            return &sector;
        }
    }
    return nullptr;
}

TEST(OriginShift, DistancesAndBearingsAreThoseFromTheOrigin) {
    const Post post{2, 0, 0.1};
    for (const auto& [ahead, left] : {std::pair{0.0, 0.3}, {0.0, -0.3}, {0.4, 0.0}, {-0.5, 0.2}, {0.3, 0.25}}) {
        const Scan scan = scanned({post}, usual(ahead, left));
        const ScanSector* const there = sector_at(scan, 0.5);
        ASSERT_NE(there, nullptr);
        EXPECT_EQ(there->state, SectorState::occupied) << ahead << ' ' << left;
        EXPECT_NEAR(there->distance_mm, 1900, 60) << ahead << ' ' << left;
        EXPECT_EQ(there->confidence, 250);
        EXPECT_LE(there->free_mm, there->distance_mm);
        const ScanSector* const aside = sector_at(scan, 12);
        EXPECT_NE(aside->state, SectorState::occupied) << ahead << ' ' << left;
    }
}

TEST(OriginShift, APostIsInTheSectorsThatItCoversAndInNoOther) {
    Random random(11);
    int seen = 0;
    for (int round = 0; round < 60; ++round) {
        ScanOptions options = usual(pick(random, -50, 50) / 100.0, pick(random, -40, 40) / 100.0);
        options.yaw_deg = pick(random, -90, 90);
        if (round % 2 == 0) {
            options.from_deg = options.yaw_deg - 60;
            options.to_deg = options.yaw_deg + 60;
        }
        const double bearing = (options.yaw_deg + pick(random, -25, 25)) * per_degree;
        const double distance = pick(random, 150, 300) / 100.0;
        const Post post{distance * std::cos(bearing), distance * std::sin(bearing), 0.15};
        const Scan scan = scanned({post}, options);
        const double half = std::asin(post.radius / post.distance()) / per_degree;
        for (const ScanSector& sector : scan.sectors) {
            const double middle = (sector.from_cdeg + sector.to_cdeg) / 200.0;
            const double sector_half = (sector.to_cdeg - sector.from_cdeg) / 200.0;
            const double away = std::abs(std::remainder(middle - post.bearing(), 360.0));
            if (away < half - sector_half) {
                EXPECT_EQ(sector.state, SectorState::occupied) << round;
                EXPECT_GT(sector.distance_mm, 1000 * (distance - post.radius) - 80) << round;
                EXPECT_LT(sector.distance_mm, 1000 * distance + 80) << round;
                ++seen;
            } else if (away > half + 3 * sector_half + 1) {
                EXPECT_NE(sector.state, SectorState::occupied) << round << ' ' << middle << ' ' << post.bearing();
            }
        }
    }
    EXPECT_GT(seen, 60);
}

TEST(OriginShift, NothingStandsWhereItIsFree) {
    Random random(5);
    int free = 0;
    for (int round = 0; round < 60; ++round) {
        ScanOptions options = usual(pick(random, -60, 60) / 100.0, pick(random, -50, 50) / 100.0);
        options.object_m = 0.2;
        std::vector<Post> posts;
        for (int i = 0; i < 4; ++i) {
            posts.push_back({pick(random, 80, 600) / 100.0, pick(random, -200, 200) / 100.0, 0.15});
        }
        const Scan scan = scanned(posts, options);
        for (const ScanSector& sector : scan.sectors) {
            free += sector.state == SectorState::free ? 1 : 0;
            // A quarter of a sector at each edge makes no obstacle of it; the posts are drawn to whole pixels.
            const double pixels = 1.5 / f / per_degree;
            const double quarter = (sector.to_cdeg - sector.from_cdeg) / 400.0 + pixels;
            for (const Post& post : posts) {
                for (double angle = 0; angle < 360; angle += 5) {
                    const Post rim{post.ahead + post.radius * std::cos(angle * per_degree),
                                   post.left + post.radius * std::sin(angle * per_degree), 0};
                    const bool within = rim.bearing() > sector.from_cdeg / 100.0 + quarter &&
                                        rim.bearing() < sector.to_cdeg / 100.0 - quarter;
                    if (within && rim.distance() > 1.1) {
                        EXPECT_LT(sector.free_mm, 1000 * rim.distance() * 1.06 + 60) << round;
                    }
                }
            }
        }
    }
    EXPECT_GT(free, 200) << "a scan that knows nothing would pass, too";
}

TEST(OriginShift, WhatTheImageDoesNotShowIsNotFree) {
    // The view is 90 degrees wide. From the origin, 0.4 m right of the camera, the ground 40 degrees to the right comes
    // into view after 3.3 m only.
    const Scan scan = scanned({}, usual(0, 0.4));
    EXPECT_EQ(sector_at(scan, -40)->state, SectorState::unknown);
    EXPECT_EQ(sector_at(scan, -40)->free_mm, 0);
    EXPECT_EQ(sector_at(scan, 10)->state, SectorState::free);
    // 44 degrees to the left it is in view all the way.
    EXPECT_EQ(sector_at(scan, 40)->state, SectorState::free);
}

TEST(OriginShift, AMillimetreChangesNextToNothing) {
    const std::vector<Post> posts{{2, 0.4, 0.15}, {3, -0.8, 0.2}, {1.2, 0.1, 0.1}};
    const Scan here = scanned(posts, usual(0, 0));
    const Scan moved = scanned(posts, usual(0.001, 0.001));
    ASSERT_EQ(here.sectors.size(), moved.sectors.size());
    for (std::size_t s = 1; s + 1 < here.sectors.size(); ++s) {
        EXPECT_EQ(here.sectors[s].state, moved.sectors[s].state) << s;
        EXPECT_EQ(here.sectors[s].from_cdeg, moved.sectors[s].from_cdeg);
        EXPECT_EQ(here.sectors[s].to_cdeg, moved.sectors[s].to_cdeg);
        EXPECT_NEAR(here.sectors[s].distance_mm, moved.sectors[s].distance_mm, 25) << s;
        EXPECT_NEAR(here.sectors[s].free_mm, moved.sectors[s].free_mm, 25) << s;
    }
}

TEST(OriginShift, LimitsCountFromTheOrigin) {
    ScanOptions options = usual(-1, 0);
    options.max_m = 3;
    const Scan scan = scanned({{2.9, 0, 0.1}}, options);
    EXPECT_EQ(sector_at(scan, 0.5)->state, SectorState::occupied) << "3.8 m from the camera";
    EXPECT_NEAR(sector_at(scan, 0.5)->distance_mm, 2800, 90);
    options.max_m = 2.5;
    const Scan nearer = scanned({{2.9, 0, 0.1}}, options);
    EXPECT_NE(sector_at(nearer, 0.5)->state, SectorState::occupied);
    EXPECT_LE(sector_at(nearer, 0.5)->free_mm, 2500);
    options.max_m = 10;
    options.min_m = 2.9;
    const Scan farther = scanned({{2.9, 0, 0.1}}, options);
    EXPECT_EQ(sector_at(farther, 0.5)->state, SectorState::unknown);
    EXPECT_EQ(sector_at(farther, 0.5)->free_mm, 0);
}

TEST(OriginShift, TheGroundsHeightIsThatAtTheOrigin) {
    ScanOptions options = usual(0.5, -0.25);
    options.ground = GroundMode::gravity;
    options.imu_axes = "right down ahead";
    ScanOptions turned;
    turned.pitch_deg = 5;
    turned.roll_deg = 3;
    const std::vector<std::int16_t> disparity(width * height, 100);
    const std::vector<std::uint8_t> confidence(width * height, 250);
    ObstacleScanner scanner(width, height, options, reference::steps.frame);
    Scan scan = scanner.empty_scan();
    scanner.scan({{disparity.data(), width, height, width}, {confidence.data(), width, height, width}},
                 {width, height, f, 160, 120, {std::lround(16 * f * baseline_mm), 0}}, scan, scan::turn_of(turned).up);
    // Below the camera the plane has nearly its configured height.
    EXPECT_NEAR(scan.ground.height_m + 0.5 * scan.ground.slope_ahead - 0.25 * scan.ground.slope_left, 0, 0.003);
    EXPECT_GT(std::abs(scan.ground.height_m), 0.03);
}

TEST(OriginShift, TheScanAroundTheCameraReachesFartherAside) {
    ScanOptions options = usual(0.3, 0.4);
    options.from_deg = -45;
    options.to_deg = 45;
    const scan::OriginShift shift(options);
    const ScanOptions& wider = shift.camera_options();
    EXPECT_EQ(wider.sectors, 45 + 2 * 45);
    EXPECT_DOUBLE_EQ(wider.from_deg, -135);
    EXPECT_DOUBLE_EQ(wider.to_deg, 135);
    EXPECT_DOUBLE_EQ(wider.max_m, 10.5);
    EXPECT_DOUBLE_EQ(wider.min_m, 0.01);
    options.sectors = 360;
    EXPECT_EQ(scan::OriginShift(options).camera_options().sectors, 360) << "there are no more";
    options.from_deg = -180;
    options.to_deg = 180;
    options.sectors = 1;
    EXPECT_EQ(scan::OriginShift(options).camera_options().sectors, 1);
}

}  // namespace
}  // namespace disparityd::test::origin_shift
