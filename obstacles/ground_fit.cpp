// SPDX-License-Identifier: Apache-2.0
#include "obstacles/ground_fit.h"

#include <algorithm>
#include <cmath>

namespace disparityd::scan {
namespace {

/// A ground has at least so many pixels of the grid, and this part of those that may show it.
constexpr int least_inliers = 80;
constexpr double least_share = 0.25;

/// Returns how far the ground may be off from the configured one, mm, `h` mm below the camera.
double largest_step(double h) {
    return std::min(1000 * max_ground_step_m, 0.4 * std::abs(h));
}

}  // namespace

GroundFit::GroundFit() {
    columns_.reserve(std::size_t{2} * grid_columns);
    slack_.reserve(std::size_t{2} * grid_rows * 2 * grid_columns);
}

void GroundFit::set(const Geometry& geometry) {
    columns_.clear();
    slack_.clear();
    const Camera& camera = geometry.camera();
    const Rays& rays = geometry.rays();
    step_y_ = std::max(camera.height / grid_rows, 1);
    const int step_x = std::max(camera.width / grid_columns, 1);
    for (int x = step_x / 2; x < camera.width; x += step_x) {
        columns_.push_back({x, rays.up(x, 0), rays.ahead(x, 0), rays.left(x, 0)});
    }
    first_y_ = step_y_ / 2;
    const auto k = static_cast<double>(camera.scale.k);
    for (int y = first_y_; y < camera.height; y += step_y_) {
        // Below a camera that has the ground under it, no ray that rises more than this meets it.
        bool may_show = geometry.options().camera_height_m <= 0;
        for (const Column& column : columns_) {
            const double ahead = rays.ahead(column.x, y);
            const double left = rays.left(column.x, y);
            slack_.push_back(1.5 * max_ground_slope * k * std::sqrt(ahead * ahead + left * left));
            may_show = may_show || k * rays.up(column.x, y) <= slack_.back();
        }
        if (!may_show && y == first_y_) {
            slack_.clear();
            first_y_ += step_y_;
        }
    }
}

void GroundFit::collect(const Pixels& pixels, const Geometry& geometry) {
    std::size_t count = 0;
    PlaneSearch::Point* const points = search_.room();
    const Camera& camera = geometry.camera();
    const Rays& rays = geometry.rays();
    const auto k = static_cast<double>(camera.scale.k);
    const double h = 1000 * geometry.options().camera_height_m;
    const double step = largest_step(h);
    const double least = geometry.limits().seen * weight_one;
    const double* slack = slack_.data();
    for (int y = first_y_; y < camera.height; y += step_y_) {
        const std::int16_t* disparity = pixels.disparity.row(y);
        const std::uint8_t* confidence = pixels.confidence.row(y);
        const std::uint16_t* weight = geometry.weights(y / group_rows);
        const double up_of_row = rays.up.per_y * y;
        const double ahead_of_row = rays.ahead.per_y * y;
        const double left_of_row = rays.left.per_y * y;
        for (const Column& column : columns_) {
            const double n = disparity[column.x] + camera.scale.offset16;
            const int measured =
                static_cast<int>(confidence[column.x] > 0) & static_cast<int>(n * weight[column.x] >= least);
            const double rise = k * (column.up + up_of_row);
            // n times the height above the configured ground, against n times what slope and step allow there.
            const int near = static_cast<int>(std::abs(h * n + rise) <= step * n + *slack++);
            // Written in any case, counted or not: branches would be guessed wrongly at every edge.
            points[count] = {static_cast<float>(n), static_cast<float>(-rise),
                             static_cast<float>(k * (column.ahead + ahead_of_row)),
                             static_cast<float>(k * (column.left + left_of_row))};
            count += static_cast<std::size_t>(measured & near);
        }
    }
    search_.take(count);
}

bool GroundFit::allowed(const PlaneSearch::Plane& plane, double h) {
    if (!(plane.p > 0)) {
        return false;
    }
    const double height = h - 1 / plane.p;
    return std::abs(height) <= largest_step(h) && std::abs(plane.q / plane.p) <= max_ground_slope &&
           std::abs(plane.t / plane.p) <= max_ground_slope;
}

std::optional<GroundPlane> GroundFit::fit(const Pixels& pixels, const Geometry& geometry, const GroundPlane& near) {
    collect(pixels, geometry);
    if (search_.count() < least_inliers) {
        return std::nullopt;
    }
    const double h = 1000 * geometry.options().camera_height_m;
    const auto tolerance = static_cast<float>(std::max(8.0, 2.5 * 16 * geometry.options().subpixel_error_px));
    const double p = 1 / (h - 1000 * near.height_m);
    int inliers = 0;
    const auto best = search_.find(
        PlaneSearch::Plane{p, p * near.slope_ahead, p * near.slope_left}, tolerance,
        [&](const PlaneSearch::Plane& plane) { return allowed(plane, h); }, inliers);
    if (!best || inliers < least_inliers || inliers < least_share * static_cast<double>(search_.count())) {
        return std::nullopt;
    }
    return GroundPlane{(h - 1 / best->p) / 1000, best->q / best->p, best->t / best->p};
}

}  // namespace disparityd::scan
