// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "kernels/image.h"

namespace disparityd {

/// Says which pixels of the rectified left image show the robot's own parts.
class ImageMask {
public:
    /// Masks nothing.
    ImageMask() = default;

    /// Masks what lies in a polygon or on its edge, and the black pixels of the image. A polygon is the whole numbers
    /// of its corners, "x,y x,y x,y" and so on, at least three of them, all within the image; its inside follows from
    /// the even-odd rule. `image` has the size of the rectified image and no value but 0 (masked) and 255, or is empty.
    /// Throws std::invalid_argument with one line for what is not allowed; `image_name` is for that line.
    ImageMask(int width, int height, std::span<const std::string> polygons, Plane<const std::uint8_t> image,
              const std::string& image_name);

    bool empty() const { return masked_.empty(); }

    /// Returns a view of it, 1 where a pixel is masked; an empty plane of an empty mask.
    Plane<const std::uint8_t> pixels() const { return {empty() ? nullptr : masked_.data(), width_, height_, width_}; }

    /// Returns whether a pixel is masked. Not for an empty mask.
    bool at(int x, int y) const {
        return masked_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)] !=
               0;
    }

    int width() const { return width_; }
    int height() const { return height_; }

private:
    struct Point {
        int x = 0;
        int y = 0;
    };

    std::vector<Point> corners(const std::string& polygon) const;
    void add_polygon(const std::string& polygon);
    void add_row(std::span<const Point> corners, int y);
    void add_image(Plane<const std::uint8_t> image, const std::string& name);
    void fill(int y, int first, int last);

    int width_ = 0;
    int height_ = 0;
    std::vector<std::uint8_t> masked_;  ///< by row and column, 1: masked; empty: nothing is
};

}  // namespace disparityd
