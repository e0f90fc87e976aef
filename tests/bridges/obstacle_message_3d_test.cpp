// SPDX-License-Identifier: Apache-2.0
//
// From a scan to OBSTACLE_DISTANCE_3D: x ahead, y right, z down, from the camera.
#include <cmath>

#include <gtest/gtest.h>

#include "bridges/mavlink/obstacle_message.h"
#include "tests/bridges/decoded_frame.h"

namespace disparityd::mavlink {
namespace {

using disparity::ScanSector;
using disparity::SectorState;

constexpr DistanceLimits limits_3d{20, 800};

ScanSector obstacle(double middle, double distance_m, double low_m = 0.1, double high_m = 0.5) {
    return {.from_deg = middle - 1,
            .to_deg = middle + 1,
            .state = SectorState::occupied,
            .distance_m = distance_m,
            .low_m = low_m,
            .high_m = high_m,
            .pixels = 100};
}

std::vector<test::DecodedFrame> sent(std::vector<ScanSector> sectors, std::optional<double> camera_height_m = {}) {
    disparity::Scan scan;
    scan.sectors = std::move(sectors);
    std::vector<test::DecodedFrame> frames;
    for (const Message& message : obstacles_3d(scan, limits_3d, camera_height_m, 123456)) {
        frames.push_back({0, 0, 0, message.kind.id, message.payload});
    }
    return frames;
}

struct Place {
    float x, y, z;

    float distance() const { return std::sqrt(x * x + y * y + z * z); }
};

Place place(const test::DecodedFrame& frame) {
    return {frame.real(4), frame.real(8), frame.real(12)};
}

TEST(ObstacleMessage3d, HasTheFieldsOfTheDefinition) {
    const auto frames = sent({obstacle(0, 2)});
    ASSERT_EQ(frames.size(), 1U);
    ASSERT_EQ(frames[0].payload.size(), 28U);
    EXPECT_EQ(frames[0].id, 11037U);
    EXPECT_EQ(frames[0].number(0, 4), 123456U);   // time_boot_ms
    EXPECT_EQ(frames[0].real(16), 0.2F);          // min_distance
    EXPECT_EQ(frames[0].real(20), 8.0F);          // max_distance
    EXPECT_EQ(frames[0].number(24, 2), 0xffffU);  // obstacle_id: not known
    EXPECT_EQ(frames[0].number(26, 1), 4U);       // sensor_type: unknown
    EXPECT_EQ(frames[0].number(27, 1), 12U);      // MAV_FRAME_BODY_FRD
}

TEST(ObstacleMessage3d, YIsToTheRight) {
    const Place left = place(sent({obstacle(30, 2)}).at(0));
    EXPECT_NEAR(left.x, 1.732051, 1e-5);
    EXPECT_NEAR(left.y, -1, 1e-5);
    EXPECT_EQ(left.z, 0);
    const Place right = place(sent({obstacle(-90, 2)}).at(0));
    EXPECT_NEAR(right.x, 0, 1e-5);
    EXPECT_NEAR(right.y, 2, 1e-5);
}

TEST(ObstacleMessage3d, ZIsThatOfThePartNearestToTheCamerasHeight) {
    EXPECT_NEAR(place(sent({obstacle(0, 2, 0.1, 0.5)}, 1.0).at(0)).z, 0.5, 1e-5);   // below: down
    EXPECT_NEAR(place(sent({obstacle(0, 2, 0.1, 0.5)}, 0.3).at(0)).z, 0, 1e-5);     // level
    EXPECT_NEAR(place(sent({obstacle(0, 2, 1.5, 2.0)}, 1.0).at(0)).z, -0.5, 1e-5);  // above
    EXPECT_NEAR(place(sent({obstacle(0, 2, 0.5, 0.1)}, 1.0).at(0)).z, 0.5, 1e-5);   // heights the wrong way round
}

TEST(ObstacleMessage3d, OnlyObstaclesWithinTheLimitsTheNearestFirst) {
    const auto frames = sent({obstacle(10, 5),
                              {.from_deg = -3, .to_deg = -1, .state = SectorState::free, .free_m = 20},
                              {.from_deg = -1, .to_deg = 1},
                              obstacle(20, 8.01),
                              obstacle(-10, 3)});
    ASSERT_EQ(frames.size(), 2U);
    EXPECT_NEAR(place(frames[0]).distance(), 3, 1e-5);
    EXPECT_NEAR(place(frames[1]).distance(), 5, 1e-5);
    EXPECT_TRUE(sent({}).empty());
}

TEST(ObstacleMessage3d, WhatIsNearerThanCanBeMeasuredIsWithinTheLimits) {
    ScanSector near = obstacle(0, 8.5);
    near.pixels = 0;
    const auto frames = sent({near});
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_NEAR(place(frames[0]).distance(), 8, 0.01);
}

TEST(ObstacleMessage3d, DistancesLieWithinTheLimitsForWhoComputesThemFromCoordinates) {
    for (double middle = -180; middle <= 180; middle += 0.5) {
        EXPECT_GE(place(sent({obstacle(middle, 0.05)}).at(0)).distance(), 0.2F) << middle;
        EXPECT_GE(place(sent({obstacle(middle, 0)}).at(0)).distance(), 0.2F) << middle;
        EXPECT_LE(place(sent({obstacle(middle, 8)}).at(0)).distance(), 8.0F) << middle;
        const Place high = place(sent({obstacle(middle, 7.9, 0, 0.1)}, 5).at(0));
        EXPECT_LE(high.distance(), 8.0F) << middle;
        EXPECT_GT(high.z, 0) << middle;
    }
}

}  // namespace
}  // namespace disparityd::mavlink
