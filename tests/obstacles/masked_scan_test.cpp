// SPDX-License-Identifier: Apache-2.0
//
// What a scan says of sectors that the robot's own parts hide. The figures are worked out by hand: f = 200 px, the
// camera is 0.3 m above the floor, the band is 0.08 to 0.5 m, the smallest obstacle 0.1 m.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "kernels/reference/steps.h"
#include "obstacles/obstacle_scanner.h"
#include "tests/obstacles/floor_view.h"

namespace disparityd::test {
namespace {

constexpr int view_width = FloorView::width;
constexpr int view_height = FloorView::height;

std::string box(int left, int top, int right, int bottom) {
    const auto corner = [](int x, int y) { return std::to_string(x) + ',' + std::to_string(y) + ' '; };
    return corner(left, top) + corner(right, top) + corner(right, bottom) + corner(left, bottom);
}

class MaskedScan : public testing::Test {
protected:
    MaskedScan() : view_({0.3, 0, 0}) {
        view_.floor().wall(5);
        options_.sectors = 31;
        options_.camera_height_m = 0.3;
        options_.high_m = 0.5;
        options_.max_m = 3;
        options_.ground = GroundMode::configured;
    }

    /// Scans with what is masked rejected; `told`: whether the scanner knows that it is masked.
    std::vector<ScanSector> sectors(const std::vector<std::string>& polygons, bool told = true) {
        const ImageMask mask(view_width, view_height, polygons, {}, "");
        const scan::Pixels seen = view_.pixels();
        std::vector<std::int16_t> disparity(seen.disparity.data, seen.disparity.data + view_width * view_height);
        std::vector<std::uint8_t> confidence(seen.confidence.data, seen.confidence.data + view_width * view_height);
        for (int i = 0; i < view_width * view_height && !mask.empty(); ++i) {
            if (mask.at(i % view_width, i / view_width)) {
                disparity[static_cast<std::size_t>(i)] = -16;
                confidence[static_cast<std::size_t>(i)] = 0;
            }
        }
        ObstacleScanner scanner(view_width, view_height, options_, reference::steps.frame, told ? mask : ImageMask());
        Scan scan = scanner.empty_scan();
        scanner.scan({{disparity.data(), view_width, view_height, view_width},
                      {confidence.data(), view_width, view_height, view_width}},
                     FloorView::camera(), scan);
        return scan.sectors;
    }

    FloorView view_;
    ScanOptions options_;
};

constexpr int middle_sector = 15;

TEST_F(MaskedScan, WithoutAMaskAllIsFree) {
    for (const ScanSector& sector : sectors({})) {
        EXPECT_EQ(sector.state, SectorState::free);
        EXPECT_GT(sector.free_mm, 2500);
    }
}

// The middle sector has the columns 155 to 164.
TEST_F(MaskedScan, ASectorOfWhichAllIsMaskedSaysSo) {
    const auto scan = sectors({box(150, 0, 169, view_height - 1)});
    EXPECT_EQ(scan[middle_sector].state, SectorState::masked);
    EXPECT_EQ(scan[middle_sector].free_mm, 0);
    EXPECT_EQ(scan[middle_sector].distance_mm, 0);
    EXPECT_EQ(scan[middle_sector - 1].state, SectorState::unknown);
    EXPECT_EQ(scan[middle_sector + 1].state, SectorState::unknown);
    EXPECT_EQ(scan[middle_sector - 2], sectors({})[middle_sector - 2]);
}

// Nine tenths of the sector are seen, which is enough where no mask is. But a mask hides the same place in each frame.
TEST_F(MaskedScan, BehindAnAntennaNothingIsFree) {
    const std::string antenna = box(159, 0, 159, view_height - 1);
    EXPECT_EQ(sectors({antenna}, false)[middle_sector].state, SectorState::free);
    const auto scan = sectors({antenna});
    EXPECT_EQ(scan[middle_sector].state, SectorState::unknown);
    EXPECT_LE(scan[middle_sector].free_mm, 200);
    EXPECT_EQ(scan[middle_sector - 1].state, SectorState::free);
    EXPECT_EQ(scan[middle_sector + 1].state, SectorState::free);
}

// Rows from 200 on fall by 0.4 to 0.6 m per metre. At 0.35 m they show 0.07 m of height, all of it in the
// band: 0.16 to 0.09 m. So 0.07 m of an obstacle, all but what is too little to be found, hides there.
TEST_F(MaskedScan, ATallBumperHidesWhatHasRoomBehindIt) {
    const std::string bumper = box(0, 200, view_width - 1, view_height - 1);
    EXPECT_GT(sectors({bumper}, false)[middle_sector].free_mm, 2500) << "0.1 m have no room";
    const auto scan = sectors({bumper});
    EXPECT_EQ(scan[middle_sector].state, SectorState::free);
    EXPECT_NEAR(scan[middle_sector].free_mm, 350, 10);
}

// Rows from 216 on fall by 0.48 to 0.6 m per metre: they show 0.07 m from 0.58 m on, where all of it is below the band.
TEST_F(MaskedScan, ALowBumperHidesTheGroundOnly) {
    EXPECT_EQ(sectors({box(0, 216, view_width - 1, view_height - 1)})[middle_sector], sectors({})[middle_sector]);
}

TEST_F(MaskedScan, WhatStandsBesideAMaskIsFound) {
    options_.max_m = 20;
    const auto scan = sectors({box(159, 0, 159, view_height - 1)});
    EXPECT_EQ(scan[middle_sector].state, SectorState::occupied);
    EXPECT_NEAR(scan[middle_sector].distance_mm, 5000, 150);
    EXPECT_LE(scan[middle_sector].free_mm, 200) << "something may hide in front of it";
}

// Five sectors of 2.49 degrees are hidden around the camera, which is 0.05 m left of the origin. Their right edge, 6.22
// degrees to the right, meets the ray from the origin that is half a sector's width less a quarter, 0.62 degrees, to
// the left after 0.05 m / (tan 6.22 + tan 0.62).
TEST_F(MaskedScan, AroundAnotherOriginTheHiddenConeEndsWhatIsFree) {
    options_.camera_left_m = 0.05;
    const auto scan = sectors({box(140, 0, 179, view_height - 1)});
    EXPECT_NEAR(scan[middle_sector].free_mm, 417, 5);
    EXPECT_GT(scan[middle_sector - 8].free_mm, 2000) << "aside of it";
}

}  // namespace
}  // namespace disparityd::test
