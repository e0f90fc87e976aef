// SPDX-License-Identifier: Apache-2.0
#include "obstacles/floor_finder.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kernels/steps.h"
#include "obstacles/obstacle_scanner.h"
#include "tests/obstacles/floor_view.h"

namespace disparityd::test {
namespace {

using scan::FloorFinder;
using scan::MountingWatch;
using testing::HasSubstr;

constexpr double sigma_px = 0.25;

void expect_near(const std::optional<Mounting>& found, const Mounting& truth) {
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->height_m, truth.height_m, 0.01 + 0.03 * truth.height_m);
    EXPECT_NEAR(found->pitch_deg, truth.pitch_deg, 1.0);
    EXPECT_NEAR(found->roll_deg, truth.roll_deg, 1.0);
}

TEST(FloorFinder, FindsTheMountingFromFloorAndWall) {
    for (const Mounting& mounting : {Mounting{0.3, 0, 0}, Mounting{1.2, 20, 0}, Mounting{0.5, -5, 8},
                                     Mounting{1.5, 42, 0}, Mounting{0.15, 3, -12}, Mounting{2.5, 35, 10}}) {
        const FloorView view = FloorView(mounting).floor().wall(6).noise(7);
        expect_near(FloorFinder().find(view.pixels(), FloorView::camera(), sigma_px), mounting);
    }
}

TEST(FloorFinder, FindsNoneWhereNoneIsInView) {
    FloorFinder finder;
    EXPECT_FALSE(finder.find(FloorView({0.3, 0, 0}).pixels(), FloorView::camera(), sigma_px)) << "nothing was measured";
    EXPECT_FALSE(finder.find(FloorView({0.3, 0, 0}).wall(2).noise(1).pixels(), FloorView::camera(), sigma_px))
        << "a wall alone";
    EXPECT_FALSE(finder.find(FloorView({0.3, -40, 0}).floor().wall(8).pixels(), FloorView::camera(), sigma_px))
        << "it looks up";
}

TEST(FloorFinder, ATableAboveTheFloorIsNone) {
    // The table fills more of the picture than the floor beyond it.
    const Mounting mounting{1.2, 30, 0};
    const FloorView view = FloorView(mounting).floor(0.7, 0.2, 1.0).floor(0, 1.0).wall(5).noise(3);
    const auto found = FloorFinder().find(view.pixels(), FloorView::camera(), sigma_px);
    if (found) {
        expect_near(found, mounting);
    }
}

TEST(MountingWatch, BelievesTenFramesThatAgree) {
    MountingWatch watch;
    for (int i = 0; i < 9; ++i) {
        watch.add(Mounting{1 + 0.002 * (i % 2), 10, 0});
        watch.add(std::nullopt);
    }
    EXPECT_FALSE(watch.found());
    watch.add(Mounting{1, 10, 0});
    ASSERT_TRUE(watch.found());
    EXPECT_NEAR(watch.found()->height_m, 1.001, 0.001);
}

TEST(MountingWatch, OneThatDiffersBeginsAnewAndTheOldOneHoldsMeanwhile) {
    MountingWatch watch;
    for (int i = 0; i < 10; ++i) {
        watch.add(Mounting{1, 10, 0});
    }
    for (int i = 0; i < 9; ++i) {
        watch.add(Mounting{1, 13, 0});
        EXPECT_EQ(watch.found()->pitch_deg, 10);
    }
    watch.add(Mounting{1, 13, 0});
    EXPECT_EQ(watch.found()->pitch_deg, 13);
    for (int i = 0; i < 40; ++i) {
        watch.add(Mounting{1, i % 2 == 0 ? 0.0 : 20.0, 0});
    }
    EXPECT_EQ(watch.found()->pitch_deg, 13) << "frames that contradict each other say nothing";
}

TEST(MountingNotice, TellsOfAContradictionOnly) {
    const ScanOptions options = options_of({0.3, 0, 0});
    EXPECT_EQ(scan::mounting_notice(std::nullopt, options), "");
    EXPECT_EQ(scan::mounting_notice(Mounting{0.34, 4, -3}, options), "");
    EXPECT_THAT(scan::mounting_notice(Mounting{0.3, 8, 0}, options), HasSubstr("a pitch of 8.0"));
    EXPECT_THAT(scan::mounting_notice(Mounting{0.45, 0, 0}, options), HasSubstr("a height of 0.45 m"));
}

TEST(MountingNotice, WhatFliesHasNoFloor) {
    ScanOptions options = options_of({0, 0, 0});
    options.low_m = -0.4;
    EXPECT_EQ(scan::mounting_notice(Mounting{1.5, 15, 0}, options), "");
}

TEST(MountingNotice, TellsWhyAScanKnowsNothing) {
    ScanOptions options = options_of({0.3, 0, 0});
    options.find_mounting = true;
    EXPECT_THAT(scan::mounting_notice(std::nullopt, options), HasSubstr("no floor has been seen"));
    EXPECT_EQ(scan::mounting_notice(Mounting{2, 30, 5}, options), "");
    EXPECT_THAT(scan::mounting_notice(Mounting{0.06, 0, 0}, options), HasSubstr("0.06 m below the camera"));
}

/// A scanner of 320 x 240 that was given a number of frames of one view.
class Scanned {
public:
    Scanned(const ScanOptions& options, const FloorView& view, int frames)
        : scanner_(FloorView::width, FloorView::height, options, fastest_frame_steps()), scan(scanner_.empty_scan()) {
        for (int i = 0; i < frames; ++i) {
            scanner_.scan(view.pixels(), FloorView::camera(), scan);
        }
    }

    const ScanSector& ahead() const { return scan.sectors[scan.sectors.size() / 2]; }

private:
    ObstacleScanner scanner_;

public:
    Scan scan;
};

constexpr int frames_to_find = 73;  // the first one and each eighth after it, ten in all

TEST(ScanOfAFoundMounting, IsThatOfTheTrueOne) {
    const Mounting mounting{1.2, 42, 0};
    const FloorView view = FloorView(mounting).floor().wall(1.5);
    ScanOptions options;
    options.high_m = 1.1;
    const Scanned wrong(options, view, frames_to_find);
    EXPECT_GT(std::abs(wrong.ahead().distance_mm - 1500), 60) << "the default mounting does not measure wrongly";
    options.find_mounting = true;
    const Scanned found(options, view, frames_to_find);
    ASSERT_EQ(found.ahead().state, SectorState::occupied);
    EXPECT_NEAR(found.ahead().distance_mm, 1500, 30);
    EXPECT_LE(found.ahead().free_mm, found.ahead().distance_mm);
}

TEST(ScanOfAFoundMounting, KnowsNothingBefore) {
    const FloorView view = FloorView({1.2, 42, 0}).floor().wall(1.5);
    ScanOptions options;
    options.find_mounting = true;
    const Scanned before(options, view, frames_to_find - 1);
    EXPECT_FALSE(before.scan.mounting);
    for (const ScanSector& sector : before.scan.sectors) {
        EXPECT_EQ(sector, ScanSector{});
    }
}

}  // namespace
}  // namespace disparityd::test
