// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "kernels/scan_counts.h"
#include "obstacles/plane_search.h"
#include "obstacles/scan.h"
#include "obstacles/scan_geometry.h"

namespace disparityd::scan {

/// The slopes of a ground's plane are at most this: 12.5 degrees.
inline constexpr double max_ground_slope = 0.2217;
/// Its height below the camera is off from the configured one by at most this, and by at most 0.4 of it.
inline constexpr double max_ground_step_m = 0.15;

/// Finds the plane of the ground in one frame: random samples, then least squares. The same input gives the same
/// result.
class GroundFit {
public:
    /// Reserves all memory.
    GroundFit();

    /// Computes what follows from the geometry alone; to be called after Geometry::set().
    void set(const Geometry& geometry);

    /// Returns the plane that most of the pixels near the configured ground lie on; nothing where too few do. `near`: a
    /// plane that is tried first.
    std::optional<GroundPlane> fit(const Pixels& pixels, const Geometry& geometry, const GroundPlane& near);

private:
    /// A column of the grid, and its rays in row 0.
    struct Column {
        int x;
        double up, ahead, left;
    };
    void collect(const Pixels& pixels, const Geometry& geometry);
    static bool allowed(const PlaneSearch::Plane& plane, double h);

    int first_y_ = 0;  ///< the first row of the grid that may show the ground
    int step_y_ = 1;
    std::vector<Column> columns_;
    std::vector<double> slack_;  ///< by row and column of the grid: what slope and step allow at n = 0
    PlaneSearch search_;
};

}  // namespace disparityd::scan
