// SPDX-License-Identifier: Apache-2.0
#include "obstacles/floor_finder.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace disparityd::scan {
namespace {

/// A floor has at least so many points of the grid, and this part of those that were measured.
constexpr int floor_inliers = 120;
constexpr double floor_share = 0.15;
/// Of those, at most this part lies below it: a table has a floor below it.
constexpr double most_below = 0.06;
/// The mountings that are looked for.
constexpr double least_height_mm = 30;
constexpr double most_height_mm = 5000;
constexpr double most_pitch_deg = 45;
constexpr double most_roll_deg = 45;

/// Frames agree when they differ by less.
constexpr double same_height_m = 0.02;
constexpr double same_height_share = 0.05;
constexpr double same_angle_deg = 1.5;
/// So many in a row are believed, and the mean is one of so many.
constexpr int enough_frames = 10;
constexpr int mean_frames = 16;

/// A mounting that differs by more is another one.
constexpr double other_height_m = 0.08;
constexpr double other_height_share = 0.15;
constexpr double other_angle_deg = 6;

/// Of a plane: its distance from the camera in mm, and the direction to it along the camera's axes.
Mounting mounting_of(const PlaneSearch::Plane& plane) {
    const double norm = std::sqrt(plane.p * plane.p + plane.q * plane.q + plane.t * plane.t);
    return {1 / (1000 * norm), std::asin(plane.q / norm) / per_degree, std::atan2(-plane.t, plane.p) / per_degree};
}

bool allowed(const PlaneSearch::Plane& plane) {
    if (!(plane.p > 0)) {
        return false;
    }
    const Mounting mounting = mounting_of(plane);
    return mounting.height_m >= least_height_mm / 1000 && mounting.height_m <= most_height_mm / 1000 &&
           std::abs(mounting.pitch_deg) <= most_pitch_deg && std::abs(mounting.roll_deg) <= most_roll_deg;
}

std::string number(const char* format, double value) {
    char text[32];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

std::string metres_text(double metres) {
    return number("%.2f", metres);
}

std::string mounting_text(const Mounting& mounting) {
    return "a height of " + metres_text(mounting.height_m) + " m, a pitch of " + number("%.1f", mounting.pitch_deg) +
           " and a roll of " + number("%.1f", mounting.roll_deg) + " degrees";
}

/// Returns a mean in which `now` is one of `count`.
Mounting mean_of(const Mounting& before, const Mounting& now, int count) {
    const auto mean = [count](double a, double b) { return a + (b - a) / count; };
    return {mean(before.height_m, now.height_m), mean(before.pitch_deg, now.pitch_deg),
            mean(before.roll_deg, now.roll_deg)};
}

}  // namespace

bool is_near(const Mounting& mounting, const Mounting& other, double height_m, double height_share, double angle_deg) {
    return std::abs(mounting.height_m - other.height_m) <= std::max(height_m, height_share * other.height_m) &&
           std::abs(mounting.pitch_deg - other.pitch_deg) <= angle_deg &&
           std::abs(mounting.roll_deg - other.roll_deg) <= angle_deg;
}

std::optional<Mounting> FloorFinder::find(const Pixels& pixels, const Camera& camera, double subpixel_error_px) {
    const int step_x = std::max(camera.width / grid_columns, 1);
    const int step_y = std::max(camera.height / grid_rows, 1);
    const auto k = static_cast<double>(camera.scale.k);
    // As Limits::seen: an image without texture has the disparity 0.
    const double least = 4 * 16 * subpixel_error_px;
    PlaneSearch::Point* const points = search_.room();
    std::size_t count = 0;
    for (int y = step_y / 2; y < camera.height; y += step_y) {
        const std::int16_t* disparity = pixels.disparity.row(y);
        const std::uint8_t* confidence = pixels.confidence.row(y);
        const auto down = static_cast<float>(k * (y - camera.cy) / camera.f);
        for (int x = step_x / 2; x < camera.width; x += step_x) {
            const double n = disparity[x] + camera.scale.offset16;
            // Written in any case, counted or not: branches would be guessed wrongly at every edge.
            points[count] = {static_cast<float>(n), down, static_cast<float>(k),
                             static_cast<float>(k * (camera.cx - x) / camera.f)};
            count += static_cast<std::size_t>(static_cast<int>(confidence[x] > 0) & static_cast<int>(n >= least));
        }
    }
    search_.take(count);
    const auto tolerance = static_cast<float>(std::max(8.0, 2.5 * 16 * subpixel_error_px));
    int inliers = 0;
    const auto plane = search_.find(std::nullopt, tolerance, allowed, inliers);
    if (!plane || inliers < floor_inliers || inliers < floor_share * static_cast<double>(count) ||
        search_.below(*plane, 2 * tolerance) > most_below * static_cast<double>(count)) {
        return std::nullopt;
    }
    return mounting_of(*plane);
}

void MountingWatch::add(const std::optional<Mounting>& seen) {
    if (!seen) {
        return;
    }
    if (agreeing_ > 0 && is_near(*seen, mean_, same_height_m, same_height_share, same_angle_deg)) {
        agreeing_ = std::min(agreeing_ + 1, mean_frames);
        mean_ = mean_of(mean_, *seen, agreeing_);
    } else {
        agreeing_ = 1;
        mean_ = *seen;
    }
    if (agreeing_ >= enough_frames) {
        found_ = mean_;
    }
}

bool is_usable(const Mounting& mounting, const ScanOptions& options) {
    return mounting.height_m >= options.low_m + 0.02;
}

std::string mounting_notice(const std::optional<Mounting>& found, const ScanOptions& options) {
    if (options.find_mounting) {
        if (!found) {
            return "obstacle scans know nothing yet: no floor has been seen from which the camera's mounting follows; "
                   "let it see the floor for some seconds, or set [scan] find_mounting = false and the mounting";
        }
        return is_usable(*found, options)
                   ? ""
                   : "obstacle scans know nothing: the floor is seen only " + metres_text(found->height_m) +
                         " m below the camera, and obstacles begin at [scan] low_m = " + metres_text(options.low_m) +
                         "; set a smaller low_m";
    }
    // A camera at height 0 flies: the floor that it sees may be anywhere.
    const bool flies = options.camera_height_m <= 0;
    const Mounting told{options.camera_height_m, options.pitch_deg, options.roll_deg};
    if (!found || flies || is_near(*found, told, other_height_m, other_height_share, other_angle_deg)) {
        return {};
    }
    return "the floor contradicts the camera's mounting, so distances and heights of obstacle scans are wrong: it "
           "shows " +
           mounting_text(*found) + ", [scan] says " + mounting_text(told) +
           "; set camera_height_m, pitch_deg and roll_deg, or find_mounting = true";
}

}  // namespace disparityd::scan
