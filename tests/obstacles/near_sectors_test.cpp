// SPDX-License-Identifier: Apache-2.0
//
// What a scan says of things that are nearer than the range.
#include "obstacles/near_sectors.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "kernels/near_plane.h"
#include "kernels/reference/steps.h"
#include "kernels/stage_notes.h"
#include "obstacles/obstacle_scanner.h"
#include "proto/doubt.h"
#include "tests/kernels/support.h"

namespace disparityd::test {
namespace {

/// A wall at 3 m all over the image, in front of it a thing that only the near guard has found: its blocks are
/// rejected.
class Near : public testing::Test {
protected:
    Near() {
        options_.sectors = 31;
        options_.camera_height_m = 0.3;
        options_.high_m = 0.5;
        options_.ground = GroundMode::configured;
    }

    void add_near(int x, int y, double depth_m = 0.5) {
        near_.at(x / near_block, y / near_block) = static_cast<std::int16_t>(std::lround(k / (1000 * depth_m)));
        for (int i = 0; i < near_block * near_block; ++i) {
            const int column = x / near_block * near_block + i % near_block;
            const int row = y / near_block * near_block + i / near_block;
            disparity_.at(column, row) = -16;
            confidence_.at(column, row) = 0;
        }
    }

    std::vector<ScanSector> sectors() {
        ObstacleScanner scanner(width, height, options_, reference::steps.frame);
        Scan scan = scanner.empty_scan();
        const scan::Camera camera{width, height, f, (width - 1) / 2.0, (height - 1) / 2.0, {std::lround(k), 0}};
        scanner.scan({disparity_.plane(), confidence_.plane()}, camera, scan, std::nullopt, {near_.plane(), 16 * last},
                     {{}, &notes_});
        return scan.sectors;
    }

    static constexpr int width = 320;
    static constexpr int height = 240;
    static constexpr double f = 200;
    static constexpr double k = 16 * f * 120;
    static constexpr int last = 31;  // candidate, which reaches to 0.774 m
    static constexpr double limit_mm = k / (16 * last);

    ScanOptions options_;
    StageNotes notes_;
    Image<std::int16_t> disparity_{width, height, static_cast<std::int16_t>(k / 3000)};
    Image<std::uint8_t> confidence_{width, height, 250};
    Image<std::int16_t> near_{near_blocks(width), near_blocks(height), not_near};
};

TEST_F(Near, ASectorWithANearThingIsOccupiedAtMostSoFar) {
    for (int y = 100; y < 140; y += near_block) {
        add_near(156, y);
        add_near(160, y);
    }
    const ScanSector ahead = sectors()[15];
    EXPECT_EQ(ahead.state, SectorState::occupied);
    EXPECT_NEAR(ahead.distance_mm, limit_mm, 3);
    EXPECT_EQ(ahead.sigma_mm, ahead.distance_mm);
    EXPECT_EQ(ahead.pixels, 0);
    EXPECT_EQ(ahead.free_mm, 0);
    EXPECT_EQ(ahead.low_mm, std::lround(1000 * options_.low_m));
    EXPECT_EQ(ahead.high_mm, 500);
    EXPECT_EQ(ahead.doubts << proto::scan_doubt_shift, proto::doubt_too_near);
    const ScanSector beside = sectors()[20];
    EXPECT_NEAR(beside.distance_mm, 3000, 500);
    EXPECT_GT(beside.pixels, 0);
    EXPECT_EQ(beside.doubts, 0);
}

TEST_F(Near, AFewBlocksAreNoObstacle) {
    add_near(160, 120);
    add_near(160, 124);  // 32 of the 2480 pixels of a sector would be enough
    EXPECT_EQ(sectors()[15].pixels, 0);
    near_.at(40, 31) = not_near;
    EXPECT_GT(sectors()[15].pixels, 0);
}

TEST_F(Near, WhatIsNotInTheBandIsNoObstacle) {
    // At 0.5 m, the rows from 239 on show what is 0.3 m below the camera: the floor.
    for (int y = 220; y < height; y += near_block) {
        for (int x = 140; x < 180; x += near_block) {
            add_near(x, y);
        }
    }
    for (const ScanSector& sector : sectors()) {
        EXPECT_GT(sector.pixels, 0);
        EXPECT_EQ(sector.doubts, 0) << "a low camera sees such floor all the time";
    }
    EXPECT_EQ(notes_.near_blocks, 0);
}

TEST_F(Near, WhatIsFarBelowTheGroundIsDoubtful) {
    // 0.15 m under the floor or more: the mounting is wrong, or there is a hole.
    for (int y = 220; y < height; y += near_block) {
        for (int x = 140; x < 180; x += near_block) {
            add_near(x, y, 0.9);
        }
    }
    EXPECT_EQ(sectors()[15].doubts << proto::scan_doubt_shift, proto::doubt_too_near);
    EXPECT_EQ(notes_.near_blocks, 50);
}

TEST_F(Near, WhatFliesHasNoGroundToLeaveOut) {
    options_.camera_height_m = 0;
    options_.low_m = -0.2;
    for (int y = 220; y < height; y += near_block) {
        for (int x = 140; x < 180; x += near_block) {
            add_near(x, y);  // 0.25 m below the camera
        }
    }
    EXPECT_EQ(sectors()[15].doubts << proto::scan_doubt_shift, proto::doubt_too_near);
    EXPECT_EQ(notes_.near_blocks, 50);
}

TEST_F(Near, WhatIsAboveTheBandIsDoubtful) {
    for (int y = 0; y < 12; y += near_block) {
        for (int x = 140; x < 180; x += near_block) {
            add_near(x, y);
        }
    }
    const ScanSector ahead = sectors()[15];
    EXPECT_GT(ahead.pixels, 0);
    EXPECT_EQ(ahead.doubts << proto::scan_doubt_shift, proto::doubt_too_near);
    EXPECT_EQ(notes_.near_blocks, 30);
}

TEST_F(Near, WhatIsMeasuredToBeNearerStays) {
    for (int y = 100; y < 140; y += near_block) {
        add_near(160, y);
        for (int x = 150; x < 160; ++x) {
            for (int i = 0; i < near_block; ++i) {
                disparity_.at(x, y + i) = static_cast<std::int16_t>(k / 700);
            }
        }
    }
    EXPECT_NEAR(sectors()[15].distance_mm, 700, 40);
    EXPECT_EQ(sectors()[15].free_mm, 0);
}

TEST_F(Near, AShiftedOriginKeepsIt) {
    options_.camera_ahead_m = 0.2;
    for (int y = 100; y < 140; y += near_block) {
        for (int x = 144; x < 176; x += near_block) {
            add_near(x, y);
        }
    }
    const ScanSector ahead = sectors()[15];
    EXPECT_EQ(ahead.state, SectorState::occupied);
    EXPECT_EQ(ahead.pixels, 0);
    EXPECT_NEAR(ahead.distance_mm, limit_mm + 200, 10);
    EXPECT_LE(ahead.free_mm, 200);
}

// The right eye does not see what is near at the left edge, so that neither match finds it.
TEST_F(Near, WhatOnlyOneEyeSeesIsNotFree) {
    constexpr int near_d = 90;
    Random random(71);
    Image<std::uint8_t> left = noise(random, width, height);
    Image<std::uint8_t> right = noise(random, width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const int d = x < 60 ? near_d : 8;
            if (x >= d) {
                right.at(x - d, y) = left.at(x, y);
            }
        }
    }
    Serial serial;
    const auto matcher = backend("reference").create({width, height, preset_options(Preset::obstacles, {0, last + 1})});
    test::Frame frame(*matcher, left, right);
    match_pair(*matcher, frame.view, serial);
    disparity_ = frame.disparity;
    confidence_ = frame.confidence;
    near_ = frame.near;
    const std::vector<ScanSector> found = sectors();
    for (std::size_t s = found.size() - 5; s < found.size(); ++s) {
        EXPECT_NE(found[s].state, SectorState::free) << s;
        EXPECT_LT(found[s].free_mm, limit_mm) << s;
    }
    EXPECT_EQ(found[15].state, SectorState::occupied);
}

}  // namespace
}  // namespace disparityd::test
