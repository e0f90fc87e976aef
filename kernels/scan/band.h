// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/scan/scan_geometry.h"

namespace disparityd::scan {

/// The disparities, in sixteenths, that a pixel needs to lie within the band of heights: both limits change linearly
/// over the image, so each is a number of its column plus one of its row.
class Band {
public:
    Band(int width, int height);

    /// Computes the limits above a plane of the ground.
    void set(const Geometry& geometry, const GroundPlane& ground);

    const std::int16_t* low_of_columns() const { return low_x_.data(); }
    const std::int16_t* high_of_columns() const { return high_x_.data(); }
    std::int16_t low_of_row(int y) const { return low_y_[static_cast<std::size_t>(y)]; }
    std::int16_t high_of_row(int y) const { return high_y_[static_cast<std::size_t>(y)]; }
    /// A pixel is within the band when its disparity is at least the low limit, and more than the high one, or less
    /// than it where the camera is above the band.
    bool above() const { return above_; }

    /// Whether pixel (x, y) with this disparity lies within the band.
    bool contains(int x, int y, int sixteenths) const {
        const int low = low_x_[static_cast<std::size_t>(x)] + low_of_row(y);
        const int high = high_x_[static_cast<std::size_t>(x)] + high_of_row(y);
        const bool below_high = above_ ? sixteenths < high : sixteenths > high;
        return (static_cast<int>(sixteenths >= low) & static_cast<int>(below_high)) != 0;
    }

private:
    std::vector<std::int16_t> low_x_, low_y_, high_x_, high_y_;
    bool above_ = false;
};

}  // namespace disparityd::scan
