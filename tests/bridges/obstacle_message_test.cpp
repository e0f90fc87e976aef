// SPDX-License-Identifier: Apache-2.0
//
// From a scan to OBSTACLE_DISTANCE. Scans count bearings to the left, the message counts its sectors to the right.
#include "bridges/mavlink/obstacle_message.h"

#include <gtest/gtest.h>

#include "tests/bridges/decoded_frame.h"

namespace disparityd::mavlink {
namespace {

using disparity::ScanSector;
using disparity::SectorState;

constexpr DistanceLimits limits{20, 800};
constexpr std::uint16_t free_cm = 801;

ScanSector occupied(double from, double to, double distance_m, double free_m = 0) {
    return {.from_deg = from,
            .to_deg = to,
            .state = SectorState::occupied,
            .distance_m = distance_m,
            .free_m = free_m,
            .pixels = 100};
}

/// Somewhere between free_m and most_m: nearer than can be measured.
ScanSector near(double from, double to, double most_m, double free_m = 0) {
    ScanSector sector = occupied(from, to, most_m, free_m);
    sector.pixels = 0;
    return sector;
}

ScanSector free_up_to(double from, double to, double free_m) {
    return {.from_deg = from, .to_deg = to, .state = SectorState::free, .free_m = free_m};
}

ScanSector unknown(double from, double to, double free_m = 0) {
    return {.from_deg = from, .to_deg = to, .state = SectorState::unknown, .free_m = free_m};
}

SectorDistances distances_of(std::vector<ScanSector> sectors) {
    disparity::Scan scan;
    scan.sectors = std::move(sectors);
    return sector_distances(scan, limits);
}

/// All sectors unknown but those that are named.
SectorDistances only(const std::vector<std::pair<std::size_t, std::uint16_t>>& known) {
    SectorDistances distances{};
    distances.fill(unknown_cm);
    for (const auto& [index, cm] : known) {
        distances.at(index) = cm;
    }
    return distances;
}

TEST(ObstacleMessage, NothingSeenIsUnknown) {
    EXPECT_EQ(distances_of({}), only({}));
    EXPECT_EQ(distances_of({unknown(-45, 45, 7.9)}), only({}));
}

TEST(ObstacleMessage, SectorZeroIsAheadAndSectorsGoToTheRight) {
    EXPECT_EQ(distances_of({occupied(-2.5, 2.5, 1.5)}), only({{0, 150}}));
    EXPECT_EQ(distances_of({occupied(-12.5, -7.5, 1.5)}), only({{2, 150}}));    // 10 degrees to the right
    EXPECT_EQ(distances_of({occupied(7.5, 12.5, 1.5)}), only({{70, 150}}));     // 10 degrees to the left
    EXPECT_EQ(distances_of({occupied(-92.5, -87.5, 1.5)}), only({{18, 150}}));  // right
    EXPECT_EQ(distances_of({occupied(87.5, 92.5, 1.5)}), only({{54, 150}}));    // left
    EXPECT_EQ(distances_of({occupied(177.5, 182.5, 1.5)}), only({{36, 150}}));  // behind
    EXPECT_EQ(distances_of({occupied(-182.5, -177.5, 1.5)}), only({{36, 150}}));
}

TEST(ObstacleMessage, DistancesAreRoundedDown) {
    EXPECT_EQ(distances_of({occupied(-2.5, 2.5, 1.239)}), only({{0, 123}}));
    for (int mm = 200; mm <= 8000; ++mm) {
        EXPECT_EQ(distances_of({occupied(-2.5, 2.5, mm / 1000.0)})[0], mm / 10) << mm << " mm";
    }
}

TEST(ObstacleMessage, ObstaclesNearerThanTheLeastDistanceAreSentThere) {
    EXPECT_EQ(distances_of({occupied(-2.5, 2.5, 0.05)}), only({{0, 20}}));
    EXPECT_EQ(distances_of({occupied(-2.5, 2.5, 0)}), only({{0, 20}}));
}

TEST(ObstacleMessage, FreeNeedsFreedomUpToTheLargestDistance) {
    EXPECT_EQ(distances_of({free_up_to(-2.5, 2.5, 8)}), only({{0, free_cm}}));
    EXPECT_EQ(distances_of({free_up_to(-2.5, 2.5, 20)}), only({{0, free_cm}}));
    EXPECT_EQ(distances_of({free_up_to(-2.5, 2.5, 7.999)}), only({}));
}

TEST(ObstacleMessage, ObstaclesBeyondTheLargestDistanceAreUnknownOrFree) {
    EXPECT_EQ(distances_of({occupied(-2.5, 2.5, 8)}), only({{0, 800}}));
    EXPECT_EQ(distances_of({occupied(-2.5, 2.5, 8.01, 8.01)}), only({{0, free_cm}}));
    EXPECT_EQ(distances_of({occupied(-2.5, 2.5, 8.01, 3)}), only({}));
}

TEST(ObstacleMessage, WhatIsNearerThanCanBeMeasuredIsAnObstacleWithinTheLimits) {
    EXPECT_EQ(distances_of({near(-2.5, 2.5, 0.66)}), only({{0, 66}}));
    EXPECT_EQ(distances_of({near(-2.5, 2.5, 8.01)}), only({{0, 800}})) << "it may be within";
    EXPECT_EQ(distances_of({near(-2.5, 2.5, 0.05)}), only({{0, 20}}));
}

TEST(ObstacleMessage, HiddenSpaceBeforeWhatIsNearerThanCanBeMeasuredCounts) {
    DistanceLimits careful = limits;
    careful.hidden_as_obstacle = true;
    disparity::Scan scan;
    scan.sectors = {near(-2.5, 2.5, 9, 0.4)};
    EXPECT_EQ(sector_distances(scan, careful), only({{0, 40}}));
}

TEST(ObstacleMessage, AnotherStateIsUnknown) {
    ScanSector sector = free_up_to(-2.5, 2.5, 20);
    sector.state = static_cast<SectorState>(3);
    EXPECT_EQ(distances_of({sector}), only({}));
}

TEST(ObstacleMessage, TheNearestObstacleOfASectorWins) {
    EXPECT_EQ(distances_of({occupied(-2.5, -1, 3), occupied(-1, 1, 2), occupied(1, 2.5, 4)}), only({{0, 200}}));
    EXPECT_EQ(distances_of({unknown(-2.5, -1), occupied(-1, 1, 2), free_up_to(1, 2.5, 20)}), only({{0, 200}}));
}

TEST(ObstacleMessage, AnObstacleIsWhereItWasMeasuredUnlessHiddenSpaceCounts) {
    EXPECT_EQ(distances_of({occupied(-2.5, 2.5, 5, 1.5)}), only({{0, 500}}));
    disparity::Scan scan;
    scan.sectors = {occupied(-2.5, 2.5, 5, 1.509), occupied(7.5, 12.5, 5, 5), occupied(17.5, 22.5, 5, 0),
                    occupied(27.5, 32.5, 9, 1.5),  unknown(37.5, 42.5, 0.1),  free_up_to(47.5, 52.5, 20)};
    DistanceLimits careful = limits;
    careful.hidden_as_obstacle = true;
    EXPECT_EQ(sector_distances(scan, careful), only({{0, 150}, {70, 500}, {68, 20}, {62, free_cm}}))
        << "what lies beyond the largest distance stays unknown";
    scan.sectors = {occupied(-2.5, 0, 3, 3), occupied(0, 2.5, 5, 2)};
    EXPECT_EQ(sector_distances(scan, careful), only({{0, 200}})) << "the nearest wins";
}

TEST(ObstacleMessage, UnknownWinsOverFree) {
    EXPECT_EQ(distances_of({free_up_to(-2.5, 0, 20), free_up_to(0, 2.5, 20)}), only({{0, free_cm}}));
    EXPECT_EQ(distances_of({free_up_to(-2.5, 0, 20), unknown(0, 2.5)}), only({}));
    EXPECT_EQ(distances_of({free_up_to(-2.5, 0, 20), free_up_to(0, 2.5, 5)}), only({}));
}

TEST(ObstacleMessage, FreeSectorsMustCoverAllOfTheMessagesSector) {
    EXPECT_EQ(distances_of({free_up_to(-2.49, 2.5, 20)}), only({}));
    EXPECT_EQ(distances_of({free_up_to(-2.5, 2.49, 20)}), only({}));
    EXPECT_EQ(distances_of({free_up_to(-2.5, -0.01, 20), free_up_to(0, 2.5, 20)}), only({}));
    // That a part is covered twice makes up for no gap.
    EXPECT_EQ(distances_of({free_up_to(-2.5, 1, 20), free_up_to(-2.5, 1, 20), free_up_to(2, 2.5, 20)}), only({}));
}

TEST(ObstacleMessage, AWideSectorShowsInAllThatItMeets) {
    EXPECT_EQ(distances_of({occupied(2.4, 7.5, 4)}), only({{71, 400}, {0, 400}}));
    EXPECT_EQ(distances_of({occupied(2.5, 7.5, 4)}), only({{71, 400}}));  // an edge alone is not met
    EXPECT_EQ(distances_of({free_up_to(-10, 10, 8)}), only({{71, free_cm}, {0, free_cm}, {1, free_cm}}));
}

TEST(ObstacleMessage, AScanMayGoAllAround) {
    SectorDistances all_free{};
    all_free.fill(free_cm);
    EXPECT_EQ(distances_of({free_up_to(-180, 180, 8)}), all_free);

    std::vector<ScanSector> narrow;  // more sectors than the message has
    for (int degree = -180; degree < 180; ++degree) {
        narrow.push_back(free_up_to(degree, degree + 1, 8));
    }
    EXPECT_EQ(distances_of(narrow), all_free);
    narrow[181 - 15] = occupied(-14, -13, 2);
    narrow[0].state = SectorState::unknown;
    SectorDistances wanted = all_free;
    wanted[3] = 200;          // 12.5 to 17.5 degrees to the right
    wanted[36] = unknown_cm;  // behind
    EXPECT_EQ(distances_of(narrow), wanted);
}

TEST(ObstacleMessage, HasTheFieldsOfTheDefinition) {
    SectorDistances distances{};
    distances.fill(unknown_cm);
    distances[1] = 123;
    const Message message = obstacle_distance(distances, limits, 0x0102030405060708);
    const test::DecodedFrame frame{0, 0, 0, message.kind.id, message.payload};
    ASSERT_EQ(frame.payload.size(), 167U);
    EXPECT_EQ(frame.id, 330U);
    EXPECT_EQ(frame.number(0, 8), 0x0102030405060708U);  // time_usec
    EXPECT_EQ(frame.distances(), distances);
    EXPECT_EQ(frame.number(152, 2), 20U);   // min_distance
    EXPECT_EQ(frame.number(154, 2), 800U);  // max_distance
    EXPECT_EQ(frame.number(156, 1), 4U);    // sensor_type: unknown
    EXPECT_EQ(frame.number(157, 1), 5U);    // increment
    EXPECT_EQ(frame.real(158), 5.0F);       // increment_f
    EXPECT_EQ(frame.real(162), 0.0F);       // angle_offset
    EXPECT_EQ(frame.number(166, 1), 12U);   // MAV_FRAME_BODY_FRD
}

}  // namespace
}  // namespace disparityd::mavlink
