// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "bridges/ros_messages/laser_scan_message.h"
#include "tests/bridges/ros_messages/cdr_reader.h"
#include "tests/bridges/ros_messages/message_frames.h"

namespace disparityd::ros {
namespace {

using disparity::Scan;
using disparity::ScanSector;
using disparity::SectorState;
using test::CdrReader;

constexpr double degree = std::numbers::pi / 180;

struct Rays {
    float first = 0;
    float last = 0;
    float step = 0;
    std::vector<float> ranges;
    std::vector<float> intensities;
};

Rays rays_in(const std::optional<std::string>& message) {
    CdrReader cdr(message.value());
    EXPECT_EQ(cdr.header(), "1700000000.123456789 camera_footprint");
    Rays rays;
    rays.first = cdr.get<float>();
    rays.last = cdr.get<float>();
    rays.step = cdr.get<float>();
    EXPECT_EQ(cdr.get<float>(4), (std::vector<float>{0, 0, 0.5F, 10}));
    rays.ranges = cdr.sequence<float>();
    rays.intensities = cdr.sequence<float>();
    EXPECT_EQ(rays.intensities.size(), rays.ranges.size());
    EXPECT_EQ(cdr.left(), 0U);
    return rays;
}

Rays rays_of(std::vector<ScanSector> sectors, HiddenSpace hidden = HiddenSpace::ignored) {
    Scan scan;
    scan.min_m = 0.5;
    scan.max_m = 10;
    scan.sectors = std::move(sectors);
    return rays_in(laser_scan(scan, test::stamp_ns, {}, hidden));
}

ScanSector occupied(double from, double to, double distance_m) {
    return {.from_deg = from,
            .to_deg = to,
            .state = SectorState::occupied,
            .distance_m = distance_m,
            .free_m = distance_m,
            .pixels = 40,
            .confidence = 99};
}

/// Nothing is known but that an obstacle is at most so far, and free up to `free_m`.
ScanSector near(double from, double to, double distance_m, double free_m) {
    ScanSector sector = occupied(from, to, distance_m);
    sector.free_m = free_m;
    sector.pixels = 0;
    sector.confidence = 0;
    return sector;
}

ScanSector free_up_to(double from, double to, double free_m) {
    return {.from_deg = from, .to_deg = to, .state = SectorState::free, .free_m = free_m};
}

TEST(RosScan, ARayIsTheMiddleOfASector) {
    const Rays rays = rays_in(laser_scan(test::grey_frame().scan().value(), test::stamp_ns));
    EXPECT_FLOAT_EQ(rays.first, static_cast<float>(-10 * degree));
    EXPECT_FLOAT_EQ(rays.last, static_cast<float>(20 * degree));
    EXPECT_FLOAT_EQ(rays.step, static_cast<float>(10 * degree));
    ASSERT_EQ(rays.ranges.size(), 4U);
    EXPECT_EQ(rays.ranges[0], 2.5F);
    EXPECT_EQ(rays.ranges[1], INFINITY);
    EXPECT_TRUE(std::isnan(rays.ranges[2])) << "free up to 4 m of 10: beyond it is unknown";
    EXPECT_TRUE(std::isnan(rays.ranges[3]));
    EXPECT_EQ(rays.intensities, (std::vector<float>{200, 0, 0, 0}));
}

TEST(RosScan, ASectorOfAnUnknownStateIsUnknown) {
    ScanSector odd = free_up_to(0, 10, 10);
    odd.state = static_cast<SectorState>(7);
    EXPECT_TRUE(std::isnan(rays_of({odd}).ranges.at(0)));
}

TEST(RosScan, GapsAreUnknown) {
    const Rays rays = rays_of({free_up_to(-20, -10, 10), free_up_to(0, 10, 10)});
    ASSERT_EQ(rays.ranges.size(), 3U);
    EXPECT_EQ(rays.ranges[0], INFINITY);
    EXPECT_TRUE(std::isnan(rays.ranges[1]));
    EXPECT_EQ(rays.ranges[2], INFINITY);
}

TEST(RosScan, NoObstacleIsLostBetweenRays) {
    // Widths of 15, 1, 1, 15 degrees: rays are 8 degrees wide.
    const Rays rays = rays_of({free_up_to(-16, -1, 10), occupied(-1, 0, 4), occupied(0, 1, 3), free_up_to(1, 16, 10)});
    ASSERT_EQ(rays.ranges.size(), 4U);
    EXPECT_EQ(rays.ranges[0], INFINITY);
    EXPECT_EQ(rays.ranges[1], 4);
    EXPECT_EQ(rays.ranges[2], 3);
    EXPECT_EQ(rays.ranges[3], INFINITY);
}

TEST(RosScan, ARayThatIsPartlyFreeIsUnknown) {
    const Rays rays = rays_of({free_up_to(0, 15, 10), free_up_to(15, 20, 3)});
    ASSERT_EQ(rays.ranges.size(), 2U);
    EXPECT_EQ(rays.ranges[0], INFINITY);
    EXPECT_TRUE(std::isnan(rays.ranges[1]));
}

TEST(RosScan, ARayEndsBeforeWhatIsTooNearToMeasure) {
    for (const HiddenSpace hidden : {HiddenSpace::ignored, HiddenSpace::obstacle}) {
        const Rays rays = rays_of({near(0, 10, 2, 0), near(10, 20, 2, 1.5), occupied(20, 30, 0.25)}, hidden);
        EXPECT_EQ(rays.ranges, (std::vector<float>{0.5F, 1.5F, 0.5F})) << "none is less than range_min";
        EXPECT_EQ(rays.intensities, (std::vector<float>{0, 0, 99}));
    }
}

TEST(RosScan, HiddenSpaceMayCountAsAnObstacle) {
    std::vector<ScanSector> sectors{occupied(0, 10, 4), occupied(10, 20, 4), occupied(20, 30, 4)};
    sectors[1].free_m = 3;
    sectors[2].free_m = 0;
    EXPECT_EQ(rays_of(sectors, HiddenSpace::ignored).ranges, (std::vector<float>{4, 4, 4}));
    EXPECT_EQ(rays_of(sectors, HiddenSpace::obstacle).ranges, (std::vector<float>{4, 3, 0.5F}));
}

TEST(RosScan, TheNearestEndOfARayWins) {
    // Widths of 9, 1, 1, 9 degrees: rays are 5 degrees wide, and the second and the third meet two sectors.
    std::vector<ScanSector> sectors{occupied(-10, -1, 4), occupied(-1, 0, 3), near(0, 1, 8, 1), occupied(1, 10, 4)};
    EXPECT_EQ(rays_of(sectors).ranges, (std::vector<float>{4, 3, 1, 4}));
    sectors[0].free_m = 2;
    EXPECT_EQ(rays_of(sectors, HiddenSpace::obstacle).ranges, (std::vector<float>{2, 2, 1, 4}));
}

TEST(RosScan, EdgesInHundredthsGiveOneRayForEachSector) {
    // 21 equal parts of 108 degrees are 5.142857 degrees wide; each other one is occupied.
    std::vector<ScanSector> sectors;
    const auto edge = [](int i) { return std::round(100 * (-54 + i * 108.0 / 21)) / 100; };
    for (int i = 0; i < 21; ++i) {
        sectors.push_back(i % 2 == 0 ? occupied(edge(i), edge(i + 1), 2 + i) : free_up_to(edge(i), edge(i + 1), 10));
    }
    const Rays rays = rays_of(sectors);
    ASSERT_EQ(rays.ranges.size(), 21U);
    for (int i = 0; i < 21; ++i) {
        EXPECT_EQ(rays.ranges[static_cast<std::size_t>(i)], i % 2 == 0 ? static_cast<float>(2 + i) : INFINITY) << i;
    }
}

TEST(RosScan, ThereIsNoneWithoutSectors) {
    EXPECT_FALSE(laser_scan(Scan{}, 0));
}

}  // namespace
}  // namespace disparityd::ros
