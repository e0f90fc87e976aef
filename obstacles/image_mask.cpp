// SPDX-License-Identifier: Apache-2.0
#include "obstacles/image_mask.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace disparityd {
namespace {

constexpr std::size_t least_corners = 3;
constexpr std::uint8_t black = 0;
constexpr std::uint8_t white = 255;

std::string size_text(int width, int height) {
    return std::to_string(width) + " x " + std::to_string(height);
}

[[noreturn]] void refuse_polygon(const std::string& polygon, const std::string& why) {
    constexpr std::size_t longest = 100;  // so that the line still says what is allowed
    const std::string shown = polygon.size() > longest ? polygon.substr(0, longest) + "..." : polygon;
    throw std::invalid_argument("mask: polygon \"" + shown + "\": " + why);
}

/// Parses "x,y"; returns whether it is that and nothing else.
bool parse_corner(const std::string& word, int& x, int& y) {
    const char* const end = word.data() + word.size();
    const auto [comma, wrong_x] = std::from_chars(word.data(), end, x);
    if (wrong_x != std::errc() || comma == end || *comma != ',') {
        return false;
    }
    const auto [rest, wrong_y] = std::from_chars(comma + 1, end, y);
    return wrong_y == std::errc() && rest == end;
}

}  // namespace

ImageMask::ImageMask(int width, int height, std::span<const std::string> polygons, Plane<const std::uint8_t> image,
                     const std::string& image_name)
    : width_(width),
      height_(height),
      masked_(polygons.empty() && !image ? 0 : static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
    for (const std::string& polygon : polygons) {
        add_polygon(polygon);
    }
    if (image) {
        add_image(image, image_name);
    }
}

std::vector<ImageMask::Point> ImageMask::corners(const std::string& polygon) const {
    std::vector<Point> points;
    std::istringstream words(polygon);
    for (std::string word; words >> word;) {
        Point point;
        if (!parse_corner(word, point.x, point.y)) {
            refuse_polygon(polygon, "found \"" + word + "\", allowed: corners \"x,y x,y x,y\" in whole pixels");
        }
        if (point.x < 0 || point.x >= width_ || point.y < 0 || point.y >= height_) {
            refuse_polygon(polygon, "found the corner " + word + ", allowed: 0,0 to " + std::to_string(width_ - 1) +
                                        ',' + std::to_string(height_ - 1) + ", the rectified image");
        }
        points.push_back(point);
    }
    if (points.size() < least_corners) {
        refuse_polygon(polygon, "found " + std::to_string(points.size()) + " corners, allowed: at least 3");
    }
    return points;
}

void ImageMask::add_polygon(const std::string& polygon) {
    const std::vector<Point> points = corners(polygon);
    const auto [top, bottom] =
        std::minmax_element(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.y < b.y; });
    for (int y = top->y; y <= bottom->y; ++y) {
        add_row(points, y);
    }
}

/// Masks what a row has of a polygon: its inside by the even-odd rule, and its edges.
void ImageMask::add_row(std::span<const Point> corners, int y) {
    std::vector<double> crossings;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        Point from = corners[i];
        Point to = corners[(i + 1) % corners.size()];
        if (from.y > to.y) {
            std::swap(from, to);
        }
        if (y < from.y || y > to.y) {
            continue;
        }
        if (from.y == to.y) {
            fill(y, std::min(from.x, to.x), std::max(from.x, to.x));
            continue;
        }
        const double x = from.x + static_cast<double>((to.x - from.x) * (y - from.y)) / (to.y - from.y);
        // An edge that passes between two pixels hides a part of both.
        fill(y, static_cast<int>(std::floor(x)), static_cast<int>(std::ceil(x)));
        if (y < to.y) {  // a corner between two edges is one crossing, or two, or none
            crossings.push_back(x);
        }
    }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
        fill(y, static_cast<int>(std::floor(crossings[i])), static_cast<int>(std::ceil(crossings[i + 1])));
    }
}

void ImageMask::fill(int y, int first, int last) {
    std::uint8_t* const row = &masked_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_)];
    std::fill(row + first, row + last + 1, std::uint8_t{1});
}

void ImageMask::add_image(Plane<const std::uint8_t> image, const std::string& name) {
    if (image.width != width_ || image.height != height_) {
        throw std::invalid_argument("mask: " + name + ": found " + size_text(image.width, image.height) +
                                    ", allowed: " + size_text(width_, height_) + ", the rectified image");
    }
    for (int y = 0; y < height_; ++y) {
        for (int x = 0; x < width_; ++x) {
            const std::uint8_t value = image.at(x, y);
            if (value == black) {
                fill(y, x, x);
            } else if (value != white) {
                throw std::invalid_argument("mask: " + name + ": found the value " + std::to_string(value) +
                                            " at pixel " + std::to_string(x) + ',' + std::to_string(y) +
                                            ", allowed: 0 (masked) and 255 (looked at)");
            }
        }
    }
}

}  // namespace disparityd
