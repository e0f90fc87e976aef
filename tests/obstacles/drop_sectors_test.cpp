// SPDX-License-Identifier: Apache-2.0
#include "obstacles/drop_sectors.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "kernels/steps.h"
#include "obstacles/obstacle_scanner.h"
#include "tests/obstacles/floor_view.h"

namespace disparityd::test {
namespace {

constexpr Mounting low_mounting{0.3, 10, 0};

/// A scan of a view with drops of more than `drop_m`.
std::vector<ScanSector> sectors_of(const FloorView& view, double drop_m) {
    ScanOptions options = options_of(low_mounting);
    options.drop_m = drop_m;
    ObstacleScanner scanner(FloorView::width, FloorView::height, options, fastest_frame_steps());
    Scan scan = scanner.empty_scan();
    scanner.scan(view.pixels(), FloorView::camera(), scan);
    return scan.sectors;
}

ScanSector ahead_of(const std::vector<ScanSector>& sectors) {
    return sectors[sectors.size() / 2];
}

FloorView step_down(double depth_m) {
    return FloorView(low_mounting)
        .floor(0, 0, 1.5)
        .floor(-depth_m, 1.5 * (1 + depth_m / low_mounting.height_m))
        .wall(8);
}

TEST(DropSectors, AStepDownIsAnObstacleWhereTheGroundEnds) {
    for (const double depth_m : {0.15, 0.3}) {
        const ScanSector ahead = ahead_of(sectors_of(step_down(depth_m), 0.1));
        ASSERT_EQ(ahead.state, SectorState::occupied);
        // Three rows are a tenth here: the robot stops before the edge, not on it.
        EXPECT_LE(ahead.distance_mm, 1520);
        EXPECT_GE(ahead.distance_mm, 1250);
        EXPECT_LE(ahead.free_mm, ahead.distance_mm);
        EXPECT_NEAR(ahead.low_mm, -1000 * depth_m, 60);
        EXPECT_EQ(ahead.high_mm, 0);
        EXPECT_GE(ahead.pixels, 12);
        EXPECT_EQ(ahead.confidence, 250);
    }
}

TEST(DropSectors, AreLookedForOnDemandOnly) {
    const ScanSector ahead = ahead_of(sectors_of(step_down(0.3), 0));
    EXPECT_GT(ahead.distance_mm, 3000) << "the wall";
}

TEST(DropSectors, AStepThatTheRobotMayTakeIsNone) {
    EXPECT_GT(ahead_of(sectors_of(step_down(0.15), 0.25)).distance_mm, 3000);
}

TEST(DropSectors, LevelGroundHasNone) {
    const FloorView view = FloorView(low_mounting).floor().wall(8);
    EXPECT_EQ(sectors_of(view, 0.1), sectors_of(view, 0));
}

TEST(DropSectors, AnObstacleBeforeTheDropWins) {
    const FloorView view = step_down(0.3).wall(1.0);
    EXPECT_EQ(sectors_of(view, 0.1), sectors_of(view, 0));
}

}  // namespace
}  // namespace disparityd::test
