// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include "kernels/matcher.h"
#include "kernels/scan_counts.h"
#include "obstacles/scan.h"
#include "obstacles/scan_options.h"

namespace disparityd::scan {

inline constexpr double per_degree = std::numbers::pi / 180;

/// The nearest number that a field of a record can hold, halves away from zero.
template <typename T>
T limited(double value) {
    constexpr double least = std::numeric_limits<T>::min();
    constexpr double most = std::numeric_limits<T>::max();
    return static_cast<T>(std::lround(std::clamp(value, least, most)));
}

constexpr std::size_t index(int value) {
    return static_cast<std::size_t>(value);
}

/// The rectified left camera.
struct Camera {
    int width = 0;
    int height = 0;
    double f = 0;  ///< px; 0: unknown, nothing can be scanned
    double cx = 0;
    double cy = 0;
    DepthScale scale;

    bool metric() const { return f > 0 && scale.k > 0; }
    friend bool operator==(const Camera& a, const Camera& b) {
        return a.width == b.width && a.height == b.height && a.f == b.f && a.cx == b.cx && a.cy == b.cy &&
               a.scale.k == b.scale.k && a.scale.offset16 == b.scale.offset16;
    }
};

/// A value that changes linearly over the image: at_origin + per_x x + per_y y.
struct Linear {
    double at_origin = 0;
    double per_x = 0;
    double per_y = 0;

    double operator()(double x, double y) const { return at_origin + per_x * x + per_y * y; }
};

/// The ray of pixel (x, y) in the robot's frame, scaled so that a point on it lies at depth Z times these.
struct Rays {
    Linear ahead;
    Linear left;
    Linear up;
};

/// How the camera is turned on the robot: the robot's axes along the camera's.
struct Turn {
    CameraDirection ahead;
    CameraDirection left;
    CameraDirection up;
};

Turn turn_of(const ScanOptions& options);

Rays make_rays(const Camera& camera, const ScanOptions& options);

/// What the rays rise above a plane of the ground.
Linear rise_above(const Rays& rays, const GroundPlane& ground);

/// Everything about sectors that follows from camera and options alone. Memory is allocated by the constructor only.
class Geometry {
public:
    Geometry(int width, int height, const ScanOptions& options);

    /// Computes all tables for another camera of the same size.
    void set(const Camera& camera);

    /// Computes all tables for another mounting of the same camera.
    void mount(const Mounting& mounting);

    const Camera& camera() const { return camera_; }
    const ScanOptions& options() const { return options_; }
    const Rays& rays() const { return rays_; }
    int sectors() const { return options_.sectors; }
    int groups() const { return groups_; }

    /// The bearing of an edge in degrees, 0 .. sectors().
    double edge_deg(int edge) const;

    /// Sixteenths of disparity to those at the horizontal distance, times weight_one; one per column.
    const std::uint16_t* weights(int group) const {
        return &weights_[static_cast<std::size_t>(group) * static_cast<std::size_t>(camera_.width)];
    }
    /// Sector s has the columns [edges(group)[s + 1], edges(group)[s]).
    const std::int16_t* edges(int group) const {
        return &edges_[static_cast<std::size_t>(group) * (static_cast<std::size_t>(sectors()) + 1)];
    }
    /// The sector of each column; sectors() where it has none.
    const std::uint16_t* sectors_of_columns(int group) const {
        return &sector_of_[static_cast<std::size_t>(group) * static_cast<std::size_t>(camera_.width)];
    }
    /// What a ray rises per horizontal metre, in the middle of a sector at the upper edge of a group, 0 .. groups().
    double rise(int sector, int group_edge) const {
        return rises_[static_cast<std::size_t>(sector) * (static_cast<std::size_t>(groups_) + 1) +
                      static_cast<std::size_t>(group_edge)];
    }
    double bearing_cos(int sector) const { return cos_[static_cast<std::size_t>(sector)]; }
    double bearing_sin(int sector) const { return sin_[static_cast<std::size_t>(sector)]; }

    const Limits& limits() const { return limits_; }

private:
    void set_limits();
    void set_group(int group);
    void set_rises();

    ScanOptions options_;
    Camera camera_;
    Rays rays_;
    int groups_;
    double from_deg_ = 0;
    double to_deg_ = 0;
    Limits limits_;
    std::vector<std::uint16_t> weights_;
    std::vector<std::int16_t> edges_;
    std::vector<std::uint16_t> sector_of_;
    std::vector<double> rises_;
    std::vector<double> cos_;  ///< of the middle of each sector
    std::vector<double> sin_;
};

}  // namespace disparityd::scan
