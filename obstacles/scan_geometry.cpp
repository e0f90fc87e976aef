// SPDX-License-Identifier: Apache-2.0
#include "obstacles/scan_geometry.h"

#include <algorithm>
#include <cmath>

namespace disparityd::scan {
namespace {

/// Rays that are steeper belong to no sector: less than half of their length is horizontal.
constexpr double least_horizontal = 0.5;
/// An image without texture has the disparity 0: what was measured is larger by so many sigmas.
constexpr double sigmas_above_nothing = 4;

/// What a pixel's ray has of one axis of the robot.
Linear linear(const Camera& camera, const CameraDirection& axis) {
    return {axis.ahead - (axis.right * camera.cx + axis.down * camera.cy) / camera.f, axis.right / camera.f,
            axis.down / camera.f};
}

}  // namespace

Turn turn_of(const ScanOptions& options) {
    const double cp = std::cos(options.pitch_deg * per_degree);
    const double sp = std::sin(options.pitch_deg * per_degree);
    const double cr = std::cos(options.roll_deg * per_degree);
    const double sr = std::sin(options.roll_deg * per_degree);
    const double cy = std::cos(options.yaw_deg * per_degree);
    const double sy = std::sin(options.yaw_deg * per_degree);
    // The columns of Rz(yaw) Ry(pitch) Rx(roll): the camera's body axes ahead, left and up in the robot's frame. The
    // image's axes are right = -left and down = -up.
    return {{-(cy * sp * sr - sy * cr), -(cy * sp * cr + sy * sr), cy * cp},
            {-(sy * sp * sr + cy * cr), -(sy * sp * cr - cy * sr), sy * cp},
            {-(cp * sr), -(cp * cr), -sp}};
}

Rays make_rays(const Camera& camera, const ScanOptions& options) {
    const Turn turn = turn_of(options);
    return {linear(camera, turn.ahead), linear(camera, turn.left), linear(camera, turn.up)};
}

Linear rise_above(const Rays& rays, const GroundPlane& ground) {
    const auto combined = [&](double Linear::*part) {
        return rays.up.*part - ground.slope_ahead * (rays.ahead.*part) - ground.slope_left * (rays.left.*part);
    };
    return {combined(&Linear::at_origin), combined(&Linear::per_x), combined(&Linear::per_y)};
}

Geometry::Geometry(int width, int height, const ScanOptions& options)
    : options_(options),
      groups_((height + group_rows - 1) / group_rows),
      weights_(index(groups_) * index(width)),
      edges_(index(groups_) * (index(options.sectors) + 1)),
      sector_of_(index(groups_) * index(width)),
      rises_(index(options.sectors) * (index(groups_) + 1)),
      cos_(index(options.sectors)),
      sin_(index(options.sectors)) {
    camera_.width = width;
    camera_.height = height;
}

double Geometry::edge_deg(int edge) const {
    return from_deg_ + (to_deg_ - from_deg_) * edge / sectors();
}

void Geometry::set(const Camera& camera) {
    camera_ = camera;
    if (!camera.metric()) {
        return;
    }
    rays_ = make_rays(camera, options_);
    from_deg_ = options_.from_deg;
    to_deg_ = options_.to_deg;
    if (from_deg_ == 0 && to_deg_ == 0) {
        const double middle = (camera.height - 1) / 2.0;
        const auto bearing = [&](double x) {
            return std::atan2(rays_.left(x, middle), rays_.ahead(x, middle)) / per_degree;
        };
        from_deg_ = bearing(camera.width - 0.5);
        to_deg_ = bearing(-0.5);
        if (to_deg_ <= from_deg_) {  // the view contains the direction where bearings jump
            to_deg_ += 360;
        }
    }
    for (int s = 0; s < sectors(); ++s) {
        const double bearing = (edge_deg(s) + edge_deg(s + 1)) / 2 * per_degree;
        cos_[index(s)] = std::cos(bearing);
        sin_[index(s)] = std::sin(bearing);
    }
    set_limits();
    for (int group = 0; group < groups_; ++group) {
        set_group(group);
    }
    set_rises();
}

void Geometry::mount(const Mounting& mounting) {
    options_.camera_height_m = mounting.height_m;
    options_.pitch_deg = mounting.pitch_deg;
    options_.roll_deg = mounting.roll_deg;
    set(camera_);
}

void Geometry::set_limits() {
    const auto k = static_cast<double>(camera_.scale.k);
    const auto sixteenths = [](double value) { return static_cast<int>(std::clamp(std::ceil(value), 1.0, 32767.0)); };
    const double sigma = 16 * options_.subpixel_error_px;
    // One sigma of the distance k / m is k sigma / m^2.
    limits_.sure = sixteenths(std::sqrt(k * sigma / (1000 * options_.max_error_m)));
    limits_.seen = std::min(limits_.sure, sixteenths(sigmas_above_nothing * sigma));
    limits_.obstacle = std::max(limits_.sure, sixteenths(k / (1000 * options_.max_m)));
    limits_.nearest = std::min(sixteenths(k / (1000 * options_.min_m)), 32766);
}

void Geometry::set_group(int group) {
    const double y = group_middle(group, camera_.height);
    std::uint16_t* weight = &weights_[index(group) * index(camera_.width)];
    for (int x = 0; x < camera_.width; ++x) {
        const double ahead = rays_.ahead(x, y);
        const double left = rays_.left(x, y);
        const double horizontal = std::sqrt(ahead * ahead + left * left);
        const bool steep = !(horizontal >= least_horizontal);
        weight[x] = static_cast<std::uint16_t>(steep ? 0 : std::floor(weight_one / horizontal + 0.5));
        weight[x] = std::min(weight[x], std::uint16_t{32767});
    }
    std::int16_t* edge = &edges_[index(group) * (index(sectors()) + 1)];
    for (int s = 0; s <= sectors(); ++s) {
        const double bearing = edge_deg(s) * per_degree;
        const double across = std::sin(bearing) * rays_.ahead.per_x - std::cos(bearing) * rays_.left.per_x;
        const double at_left = std::sin(bearing) * rays_.ahead(0, y) - std::cos(bearing) * rays_.left(0, y);
        // The sine of the angle from a ray to the edge grows with the column, unless the edge lies behind the camera.
        double column = 0;
        if (across > 1e-12) {
            column = std::ceil(-at_left / across);
        } else {
            const double turned = edge_deg(s) - options_.yaw_deg;
            column = std::remainder(turned, 360.0) > 0 ? 0 : camera_.width;
        }
        edge[s] = static_cast<std::int16_t>(std::clamp(column, 0.0, static_cast<double>(camera_.width)));
    }
    for (int s = 1; s <= sectors(); ++s) {
        edge[s] = std::min(edge[s], edge[s - 1]);
    }
    std::uint16_t* sector = &sector_of_[index(group) * index(camera_.width)];
    std::fill_n(sector, camera_.width, static_cast<std::uint16_t>(sectors()));
    for (int s = 0; s < sectors(); ++s) {
        std::fill(sector + edge[s + 1], sector + edge[s], static_cast<std::uint16_t>(s));
    }
}

void Geometry::set_rises() {
    for (int s = 0; s < sectors(); ++s) {
        for (int group = 0; group <= groups_; ++group) {
            const double y = std::min(group * group_rows, camera_.height) - 0.5;
            // On this row, the column whose ray has the sector's bearing.
            const double sine = sin_[index(s)];
            const double cosine = cos_[index(s)];
            const double across = sine * rays_.ahead.per_x - cosine * rays_.left.per_x;
            const double at_left = sine * rays_.ahead(0, y) - cosine * rays_.left(0, y);
            const double x = across > 1e-12 ? -at_left / across : (camera_.width - 1) / 2.0;
            const double horizontal = std::max(cosine * rays_.ahead(x, y) + sine * rays_.left(x, y), 1e-3);
            rises_[index(s) * (index(groups_) + 1) + index(group)] = rays_.up(x, y) / horizontal;
        }
    }
}

}  // namespace disparityd::scan
