// SPDX-License-Identifier: Apache-2.0
//
// How far the sectors of a scan can be trusted, and why not.
#include "obstacles/sector_doubts.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "kernels/reference/steps.h"
#include "obstacles/obstacle_scanner.h"
#include "proto/doubt.h"
#include "tests/kernels/support.h"

namespace disparityd::test {
namespace {

/// A wall at 3 m, measured all over the image.
class SectorDoubts : public testing::Test {
protected:
    SectorDoubts() {
        options_.sectors = 32;
        options_.ground = GroundMode::configured;
    }

    std::vector<ScanSector> sectors() {
        ObstacleScanner scanner(width, height, options_, reference::steps.frame);
        Scan scan = scanner.empty_scan();
        const scan::Camera camera{width, height, f, (width - 1) / 2.0, (height - 1) / 2.0, {std::lround(k), 0}};
        scanner.scan({disparity_.plane(), confidence_.plane()}, camera, scan, std::nullopt, {},
                     {left_.plane(), &notes_});
        return scan.sectors;
    }

    /// Returns the doubts of each sector as bits of a frame's flags.
    std::vector<std::uint32_t> doubts() {
        std::vector<std::uint32_t> list;
        for (const ScanSector& sector : sectors()) {
            list.push_back(std::uint32_t{sector.doubts} << proto::scan_doubt_shift);
        }
        return list;
    }

    /// Fills columns of the left image from the top down to a row.
    void fill(int first_x, int end_x, int end_y, std::uint8_t level) {
        for (int y = 0; y < end_y; ++y) {
            std::fill(left_.plane().row(y) + first_x, left_.plane().row(y) + end_x, level);
        }
    }

    static constexpr int width = 320;
    static constexpr int height = 240;
    static constexpr double f = 200;
    static constexpr double k = 16 * f * 120;
    // The sectors of the left and of the right half of the image.
    static constexpr std::size_t leftmost = 31;
    static constexpr std::size_t rightmost = 0;

    ScanOptions options_;
    StageNotes notes_;
    Image<std::uint8_t> left_{width, height, 100};
    Image<std::int16_t> disparity_{width, height, static_cast<std::int16_t>(k / 3000)};
    Image<std::uint8_t> confidence_{width, height, 250};
};

TEST_F(SectorDoubts, AGoodPictureHasNone) {
    for (const ScanSector& sector : sectors()) {
        EXPECT_EQ(sector.doubts, 0);
        EXPECT_EQ(sector.trust, 255);
    }
}

TEST_F(SectorDoubts, TrustIsWhatWasMeasured) {
    for (int y = 0; y < height; ++y) {
        std::fill_n(confidence_.plane().row(y), y < height * 7 / 10 ? width / 2 : 0, std::uint8_t{0});
    }
    const std::vector<ScanSector> found = sectors();
    EXPECT_EQ(found[rightmost].trust, 255);
    EXPECT_EQ(found[leftmost].trust, 255 * (255 * 9 / 30) / 153) << "9 of 30 groups of rows are measured";
}

TEST_F(SectorDoubts, OnlyTheDarkPartIsDark) {
    fill(0, width / 2, height, 19);
    EXPECT_EQ(doubts()[leftmost], proto::doubt_dark);
    EXPECT_EQ(doubts()[rightmost], 0U);
    EXPECT_EQ(sectors()[leftmost].trust, 127) << "half of it is left";
    notes_.dark_level = 19;
    EXPECT_EQ(doubts()[leftmost], 0U);
}

TEST_F(SectorDoubts, AQuarterMayBeWhite) {
    fill(0, width / 2, 8 * 7, 250);
    EXPECT_EQ(doubts()[leftmost], 0U) << "7 of 30 groups of rows";
    fill(0, width / 2, 8 * 8, 250);
    EXPECT_EQ(doubts()[leftmost], proto::doubt_saturated);
    EXPECT_EQ(doubts()[rightmost], 0U);
}

TEST_F(SectorDoubts, DirtIsWhereTrustHasFoundIt) {
    notes_.dirty = {{0, 80, 40, 107}};
    EXPECT_EQ(doubts()[leftmost], proto::doubt_dirty_eye) << "3 of 30 groups of rows";
    EXPECT_EQ(doubts()[rightmost], 0U);
    notes_.dirty = {{0, 80, 40, 100}};
    EXPECT_EQ(doubts()[leftmost], 0U) << "2 of 30";
    notes_.dirty.push_back({0, 100, 40, 107});
    EXPECT_EQ(doubts()[leftmost], proto::doubt_dirty_eye) << "boxes add up";
}

TEST_F(SectorDoubts, AnotherOriginKeepsThem) {
    options_.camera_ahead_m = 0.2;
    fill(0, width / 2, height, 19);
    EXPECT_EQ(doubts()[leftmost], proto::doubt_dark);
    EXPECT_EQ(doubts()[rightmost], 0U);
    EXPECT_EQ(sectors()[rightmost].trust, 255);
}

// The wall is 3 m before the camera, 1 m before the origin: what is on the left of the picture is farther left from
// there.
TEST_F(SectorDoubts, AnotherOriginHasThemWhereTheyAreSeenFromThere) {
    options_.camera_ahead_m = -2;
    options_.from_deg = -70;
    options_.to_deg = 70;
    options_.sectors = 70;
    fill(0, 80, height, 19);  // from 22 degrees to the left on for the camera, which is 1.2 m aside at the wall
    const std::vector<std::uint32_t> from_there = doubts();
    const auto at = [&from_there](int bearing) { return from_there[static_cast<std::size_t>((bearing + 70) / 2)]; };
    EXPECT_EQ(at(28), 0U) << "0.53 m aside at the wall";
    EXPECT_EQ(at(56), proto::doubt_dark) << "1.5 m aside";
    EXPECT_EQ(at(-56), 0U);
    options_.camera_ahead_m = 0;
    const std::vector<std::uint32_t> from_camera = doubts();
    EXPECT_EQ(from_camera[(28 + 70) / 2], proto::doubt_dark);
}

// The camera is 0.3 m to the left of the origin: it sees what is near on the way straight ahead farther to the right.
TEST_F(SectorDoubts, AnotherOriginHasThoseOfTheWholeWay) {
    options_.camera_left_m = 0.3;
    options_.from_deg = -36;
    options_.to_deg = 36;
    options_.sectors = 24;
    fill(202, 232, height, 19);  // from 12 to 20 degrees to the right, where the way is 0.8 to 1.4 m away
    const std::vector<ScanSector> found = sectors();
    EXPECT_EQ(std::uint32_t{found[12].doubts} << proto::scan_doubt_shift, proto::doubt_dark);
    EXPECT_EQ(found[12].trust, 127);
    EXPECT_EQ(found[0].doubts, 0) << "its way is farther to the right than the dark";
}

TEST_F(SectorDoubts, WithoutACalibrationNothingIsTold) {
    ObstacleScanner scanner(width, height, options_, reference::steps.frame);
    Scan scan = scanner.empty_scan();
    notes_.near_blocks = 7;
    scanner.scan({disparity_.plane(), confidence_.plane()}, {width, height, 0, 0, 0, {}}, scan, std::nullopt, {},
                 {left_.plane(), &notes_});
    EXPECT_EQ(scan.sectors[0].trust, 0);
    EXPECT_FALSE(notes_.near_blocks.has_value()) << "that of a frame before";
}

}  // namespace
}  // namespace disparityd::test
