// SPDX-License-Identifier: Apache-2.0
#include "obstacles/floor_finder.h"

#include <cmath>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kernels/steps.h"
#include "obstacles/obstacle_scanner.h"

namespace disparityd::test {
namespace {

using scan::FloorFinder;
using scan::MountingWatch;
using testing::HasSubstr;

constexpr double sigma_px = 0.25;

ScanOptions options_of(const Mounting& mounting) {
    ScanOptions options;
    options.camera_height_m = mounting.height_m;
    options.pitch_deg = mounting.pitch_deg;
    options.roll_deg = mounting.roll_deg;
    return options;
}

/// The disparities of a level plane below a camera, and of what stands upright on it.
class View {
public:
    static constexpr int width = 320;
    static constexpr int height = 240;

    static scan::Camera camera() {
        return {width, height, f, (width - 1) / 2.0, (height - 1) / 2.0, {std::lround(16 * f * baseline_mm), 0}};
    }

    explicit View(const Mounting& mounting)
        : mounting_(mounting),
          rays_(scan::make_rays(camera(), options_of(mounting))),
          disparity_(width * height, -16),
          confidence_(width * height, 0) {}

    /// A floor `above_m` above the one on which the camera stands, between these distances ahead.
    View& floor(double above_m = 0, double from_m = 0, double to_m = 15) {
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const double z = (above_m - mounting_.height_m) / rays_.up(x, y);
                const double ahead = z * rays_.ahead(x, y);
                if (z > 0 && ahead >= from_m && ahead <= to_m) {
                    put(x, y, z);
                }
            }
        }
        return *this;
    }
    View& wall(double ahead_m) {
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                put(x, y, ahead_m / rays_.ahead(x, y));
            }
        }
        return *this;
    }
    /// Moves each disparity by a random number of sixteenths, and one of twenty anywhere.
    View& noise(unsigned seed) {
        std::mt19937 random(seed);
        for (std::size_t i = 0; i < disparity_.size(); ++i) {
            if (confidence_[i] != 0) {
                const auto change = static_cast<int>(random() % 9) - 4;
                disparity_[i] =
                    static_cast<std::int16_t>(random() % 20 == 0 ? random() % 1000 : disparity_[i] + change);
            }
        }
        return *this;
    }
    scan::Pixels pixels() const {
        return {{disparity_.data(), width, height, width}, {confidence_.data(), width, height, width}};
    }

private:
    static constexpr double f = 200;
    static constexpr double baseline_mm = 120;

    /// What is nearer stays.
    void put(int x, int y, double z_m) {
        const auto i = static_cast<std::size_t>(y * width + x);
        const auto d16 = static_cast<std::int16_t>(std::lround(16 * f * baseline_mm / (1000 * z_m)));
        if (z_m > 0 && d16 > disparity_[i]) {
            disparity_[i] = d16;
            confidence_[i] = 250;
        }
    }

    Mounting mounting_;
    scan::Rays rays_;
    std::vector<std::int16_t> disparity_;
    std::vector<std::uint8_t> confidence_;
};

void expect_near(const std::optional<Mounting>& found, const Mounting& truth) {
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->height_m, truth.height_m, 0.01 + 0.03 * truth.height_m);
    EXPECT_NEAR(found->pitch_deg, truth.pitch_deg, 1.0);
    EXPECT_NEAR(found->roll_deg, truth.roll_deg, 1.0);
}

TEST(FloorFinder, FindsTheMountingFromFloorAndWall) {
    for (const Mounting& mounting : {Mounting{0.3, 0, 0}, Mounting{1.2, 20, 0}, Mounting{0.5, -5, 8},
                                     Mounting{1.5, 42, 0}, Mounting{0.15, 3, -12}, Mounting{2.5, 35, 10}}) {
        const View view = View(mounting).floor().wall(6).noise(7);
        expect_near(FloorFinder().find(view.pixels(), View::camera(), sigma_px), mounting);
    }
}

TEST(FloorFinder, FindsNoneWhereNoneIsInView) {
    FloorFinder finder;
    EXPECT_FALSE(finder.find(View({0.3, 0, 0}).pixels(), View::camera(), sigma_px)) << "nothing was measured";
    EXPECT_FALSE(finder.find(View({0.3, 0, 0}).wall(2).noise(1).pixels(), View::camera(), sigma_px)) << "a wall alone";
    EXPECT_FALSE(finder.find(View({0.3, -40, 0}).floor().wall(8).pixels(), View::camera(), sigma_px)) << "it looks up";
}

TEST(FloorFinder, ATableAboveTheFloorIsNone) {
    // The table fills more of the picture than the floor beyond it.
    const Mounting mounting{1.2, 30, 0};
    const View view = View(mounting).floor(0.7, 0.2, 1.0).floor(0, 1.0).wall(5).noise(3);
    const auto found = FloorFinder().find(view.pixels(), View::camera(), sigma_px);
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
    Scanned(const ScanOptions& options, const View& view, int frames)
        : scanner_(View::width, View::height, options, fastest_frame_steps()), scan(scanner_.empty_scan()) {
        for (int i = 0; i < frames; ++i) {
            scanner_.scan(view.pixels(), View::camera(), scan);
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
    const View view = View(mounting).floor().wall(1.5);
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
    const View view = View({1.2, 42, 0}).floor().wall(1.5);
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
