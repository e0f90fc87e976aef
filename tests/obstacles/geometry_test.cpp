// SPDX-License-Identifier: Apache-2.0
//
// The tables of a scan against points that are turned by matrices and measured with a tape, so to speak.
#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "kernels/scan_counts.h"
#include "obstacles/band.h"
#include "obstacles/scan_geometry.h"
#include "tests/kernels/support.h"

namespace disparityd::test {
namespace {

using Vector = std::array<double, 3>;
using Matrix = std::array<Vector, 3>;

Matrix times(const Matrix& a, const Matrix& b) {
    Matrix c{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            for (std::size_t k = 0; k < 3; ++k) {
                c[i][j] += a[i][k] * b[k][j];
            }
        }
    }
    return c;
}

Vector times(const Matrix& a, const Vector& v) {
    Vector w{};
    for (std::size_t i = 0; i < 3; ++i) {
        w[i] = a[i][0] * v[0] + a[i][1] * v[1] + a[i][2] * v[2];
    }
    return w;
}

/// The usual rotations of a body with the axes ahead, left and up.
Matrix mounting(const ScanOptions& options) {
    const auto rad = [](double degrees) { return degrees * std::numbers::pi / 180; };
    const double y = rad(options.yaw_deg);
    const double p = rad(options.pitch_deg);
    const double r = rad(options.roll_deg);
    const Matrix yaw{{{std::cos(y), -std::sin(y), 0}, {std::sin(y), std::cos(y), 0}, {0, 0, 1}}};
    const Matrix pitch{{{std::cos(p), 0, std::sin(p)}, {0, 1, 0}, {-std::sin(p), 0, std::cos(p)}}};
    const Matrix roll{{{1, 0, 0}, {0, std::cos(r), -std::sin(r)}, {0, std::sin(r), std::cos(r)}}};
    return times(yaw, times(pitch, roll));
}

/// The point that a pixel with so many sixteenths of disparity shows, in mm, the camera at (0, 0, h).
Vector point_of(const scan::Camera& camera, const ScanOptions& options, int x, int y, int sixteenths) {
    const double z = static_cast<double>(camera.scale.k) / sixteenths;
    const Vector body{z, -(x - camera.cx) * z / camera.f, -(y - camera.cy) * z / camera.f};
    Vector point = times(mounting(options), body);
    point[2] += 1000 * options.camera_height_m;
    return point;
}

class AnyMounting : public testing::Test {
protected:
    static constexpr int width = 320;
    static constexpr int height = 200;

    /// A camera that is turned any way, but does not look at the sky or at its feet.
    ScanOptions options() {
        ScanOptions options;
        options.pitch_deg = pick(random_, -25, 25);
        options.roll_deg = pick(random_, -20, 20);
        options.yaw_deg = pick(random_, -170, 170);
        options.camera_height_m = pick(random_, 30, 200) / 100.0;
        options.low_m = pick(random_, -50, 10) / 100.0;
        options.high_m = options.low_m + pick(random_, 10, 200) / 100.0;
        options.sectors = pick(random_, 1, 90);
        return options;
    }

    static scan::Camera camera() { return {width, height, 200, 155.25, 103.5, {16L * 200 * 120, 0}}; }

    Random random_{42};
};

TEST_F(AnyMounting, DistanceIsTheOneOfThePoint) {
    for (int round = 0; round < 200; ++round) {
        const ScanOptions chosen = options();
        scan::Geometry geometry(width, height, chosen);
        geometry.set(camera());
        const int x = pick(random_, 0, width - 1);
        const int group = pick(random_, 0, geometry.groups() - 1);
        const int y = group * scan::group_rows + scan::group_rows / 2;  // the row that a group's weights are made for
        const Vector point = point_of(camera(), chosen, x, y, 640);
        const double m = 640.0 * geometry.weights(group)[x] / scan::weight_one;
        EXPECT_NEAR(static_cast<double>(camera().scale.k) / m / std::hypot(point[0], point[1]), 1, 0.001);
    }
}

TEST_F(AnyMounting, SectorIsTheOneOfTheBearing) {
    int checked = 0;
    for (int round = 0; round < 2000; ++round) {
        const ScanOptions chosen = options();
        scan::Geometry geometry(width, height, chosen);
        geometry.set(camera());
        const int x = pick(random_, 0, width - 1);
        const int group = pick(random_, 0, geometry.groups() - 1);
        const Vector point = point_of(camera(), chosen, x, group * scan::group_rows + scan::group_rows / 2, 640);
        const double bearing = std::atan2(point[1], point[0]) * 180 / std::numbers::pi;
        for (int s = 0; s < geometry.sectors(); ++s) {
            const double turned = std::remainder(bearing - geometry.edge_deg(s), 360.0);
            const double wide = geometry.edge_deg(s + 1) - geometry.edge_deg(s);
            const std::int16_t* edges = geometry.edges(group);
            const bool has = x >= edges[s + 1] && x < edges[s];
            // A pixel is 0.3 degrees wide: at an edge either may have it.
            if (std::abs(turned) > 1e-6 && std::abs(turned - wide) > 1e-6) {
                EXPECT_EQ(has, turned > 0 && turned < wide) << bearing << " in sector " << s;
                checked += has ? 1 : 0;
            }
        }
    }
    EXPECT_GT(checked, 1000);
}

TEST_F(AnyMounting, BandHoldsWhatLiesBetweenItsHeights) {
    int inside = 0;
    for (int round = 0; round < 5000; ++round) {
        ScanOptions chosen = options();
        chosen.subpixel_error_px = 0.01;
        scan::Geometry geometry(width, height, chosen);
        geometry.set(camera());
        scan::Band band(width, height);
        const GroundPlane ground{pick(random_, -10, 10) / 100.0, pick(random_, -20, 20) / 100.0,
                                 pick(random_, -20, 20) / 100.0};
        band.set(geometry, ground);
        const int x = pick(random_, 0, width - 1);
        const int y = pick(random_, 0, height - 1);
        const int n = pick(random_, 30, 900);
        const Vector point = point_of(camera(), chosen, x, y, n);
        const double above = point[2] / 1000 - ground.height_m - ground.slope_ahead * point[0] / 1000 -
                             ground.slope_left * point[1] / 1000;
        const auto near_limit = [&](double limit) {
            // One unit of rounding per table, and the margin of the low limit, in sixteenths. A limit as high as the
            // camera counts as up to 4 cm farther away.
            const double h = chosen.camera_height_m - ground.height_m;
            return std::abs(above - limit) <= 2.6 / n * std::abs(h - limit) + (std::abs(h - limit) < 0.04 ? 0.04 : 0);
        };
        if (near_limit(chosen.low_m) || near_limit(chosen.high_m)) {
            continue;
        }
        const bool expected = above >= chosen.low_m && above < chosen.high_m;
        EXPECT_EQ(scan::count_tables(geometry, band).in_band(x, y, n), expected)
            << above << " between " << chosen.low_m << " and " << chosen.high_m << ", camera at "
            << chosen.camera_height_m;
        inside += expected ? 1 : 0;
    }
    EXPECT_GT(inside, 500);
}

TEST(ScanGeometry, FieldOfViewIsThatOfTheCamera) {
    scan::Geometry geometry(100, 60, ScanOptions{});
    geometry.set({100, 60, 50, 49.5, 29.5, {16L * 50 * 120, 0}});
    EXPECT_NEAR(geometry.edge_deg(0), -45, 1e-9);
    EXPECT_NEAR(geometry.edge_deg(72), 45, 1e-9);
    EXPECT_EQ(geometry.edges(3)[0], 100);
    EXPECT_EQ(geometry.edges(3)[72], 0);
    EXPECT_EQ(geometry.edges(3)[36], 50);
}

TEST(ScanGeometry, LimitsFollowFromErrorAndDistances) {
    ScanOptions options;
    options.min_m = 0.5;
    options.max_m = 4;
    options.max_error_m = 1;
    options.subpixel_error_px = 0.25;
    scan::Geometry geometry(100, 60, options);
    geometry.set({100, 60, 50, 49.5, 29.5, {96000, 0}});  // f B = 6000 px mm
    // One sigma is 4 sixteenths: 96000 * 4 / m^2 = 1000 at m = 19.6.
    EXPECT_EQ(geometry.limits().sure, 20);
    EXPECT_EQ(geometry.limits().seen, 16);
    EXPECT_EQ(geometry.limits().obstacle, 24);
    EXPECT_EQ(geometry.limits().nearest, 192);
}

TEST(ScanBins, AreAQuarterWideThenAThirtySecond) {
    EXPECT_EQ(scan::bin_of(0), 0);
    EXPECT_EQ(scan::bin_of(4), 1);
    EXPECT_EQ(scan::bin_of(127), 31);
    EXPECT_EQ(scan::bin_of(255), 63);
    EXPECT_EQ(scan::bin_of(256), 64);
    EXPECT_EQ(scan::bin_of(263), 64);
    EXPECT_EQ(scan::bin_of(264), 65);
    EXPECT_EQ(scan::bin_of(100000), scan::used_bins - 1);
    for (int m = 1; m < 8192; ++m) {
        const int bin = scan::bin_of(m);
        EXPECT_LE(scan::bin_begin(bin), m);
        EXPECT_GT(scan::bin_begin(bin + 1), m);
    }
}

}  // namespace
}  // namespace disparityd::test
