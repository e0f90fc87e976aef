// SPDX-License-Identifier: Apache-2.0
#include "calibration/board/markers.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <opencv2/imgproc.hpp>

namespace disparityd::calibration {

namespace {

using Quad = std::array<cv::Point2f, 4>;

constexpr double min_side = 8;  // px; the bits of smaller markers cannot be read

double area(const Quad& quad) {
    double twice = 0;
    for (std::size_t i = 0; i < quad.size(); ++i) {
        twice += quad[i].cross(quad[(i + 1) % quad.size()]);
    }
    return twice / 2;
}

/// A straight line as cv::fitLine() returns it: direction, then a point.
using Line = cv::Vec4f;

std::optional<cv::Point2f> crossing(const Line& a, const Line& b) {
    const float turn = a[0] * b[1] - a[1] * b[0];
    if (std::abs(turn) < 0.1F) {
        return std::nullopt;
    }
    const float way = ((b[2] - a[2]) * b[1] - (b[3] - a[3]) * b[0]) / turn;
    return cv::Point2f(a[2] + way * a[0], a[3] + way * a[1]);
}

/// Fits a line to the points of a contour from one of its points to a later one, without those near the ends.
std::optional<Line> side_of(const std::vector<cv::Point>& contour, cv::Point from, cv::Point to) {
    const auto index = [&](cv::Point point) {
        return static_cast<std::size_t>(std::find(contour.begin(), contour.end(), point) - contour.begin());
    };
    const std::size_t first = index(from);
    const std::size_t count = (index(to) + contour.size() - first) % contour.size();
    std::vector<cv::Point> points;
    for (std::size_t i = count / 8 + 1; i + count / 8 < count; ++i) {
        points.push_back(contour[(first + i) % contour.size()]);
    }
    if (points.size() < 3) {
        return std::nullopt;
    }
    Line line;
    cv::fitLine(points, line, cv::DIST_L2, 0, 0.01, 0.01);
    return line;
}

/// Returns the corners where the sides of a contour meet: those of its polygon are a few pixels off.
std::optional<Quad> sharp(const std::vector<cv::Point>& contour, const std::vector<cv::Point>& polygon) {
    std::array<Line, 4> sides;
    for (std::size_t i = 0; i < sides.size(); ++i) {
        const auto side = side_of(contour, polygon[i], polygon[(i + 1) % 4]);
        if (!side) {
            return std::nullopt;
        }
        sides[i] = *side;
    }
    Quad quad;
    for (std::size_t i = 0; i < quad.size(); ++i) {
        const auto corner = crossing(sides[(i + 3) % 4], sides[i]);
        if (!corner || cv::norm(*corner - cv::Point2f(polygon[i])) > min_side) {
            return std::nullopt;
        }
        quad[i] = *corner;
    }
    return quad;
}

/// A contour with four straight sides; its corners are clockwise in the image.
std::optional<Quad> quad_of(const std::vector<cv::Point>& contour) {
    const double length = cv::arcLength(contour, true);
    if (length < 4 * min_side) {
        return std::nullopt;
    }
    std::vector<cv::Point> polygon;
    cv::approxPolyDP(contour, polygon, 0.04 * length, true);
    if (polygon.size() != 4 || !cv::isContourConvex(polygon)) {
        return std::nullopt;
    }
    auto quad = sharp(contour, polygon);
    for (std::size_t i = 0; quad && i < quad->size(); ++i) {
        if (cv::norm((*quad)[(i + 1) % 4] - (*quad)[i]) < min_side) {
            quad.reset();
        }
    }
    if (quad && area(*quad) < 0) {
        std::swap((*quad)[1], (*quad)[3]);
    }
    return quad;
}

/// Reads the bits within a quad; nothing when it has no black rim.
std::optional<std::uint64_t> read_bits(const cv::Mat& image, const Quad& quad, int side) {
    constexpr int cell = 8;
    const int cells = side + 2;
    const auto size = static_cast<float>(cells * cell);
    const Quad square{cv::Point2f(0, 0), cv::Point2f(size, 0), cv::Point2f(size, size), cv::Point2f(0, size)};
    cv::Mat flat;
    cv::warpPerspective(image, flat, cv::getPerspectiveTransform(quad.data(), square.data()),
                        {cells * cell, cells * cell}, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    // A threshold splits noise into two halves, too.
    constexpr double least_contrast = 10;
    cv::Scalar mean;
    cv::Scalar spread;
    cv::meanStdDev(flat, mean, spread);
    if (spread[0] < least_contrast) {
        return std::nullopt;
    }
    cv::Mat white;
    cv::threshold(flat, white, 0, 255, cv::THRESH_BINARY | cv::THRESH_OTSU);
    std::uint64_t bits = 0;
    int wrong_rim = 0;
    for (int y = 0; y < cells; ++y) {
        for (int x = 0; x < cells; ++x) {
            const cv::Rect middle(x * cell + cell / 4, y * cell + cell / 4, cell / 2, cell / 2);
            const bool is_white = cv::mean(white(middle))[0] > 127;
            if (x == 0 || y == 0 || x == cells - 1 || y == cells - 1) {
                wrong_rim += is_white ? 1 : 0;
            } else {
                bits = bits << 1U | (is_white ? 1U : 0U);
            }
        }
    }
    return wrong_rim <= cells / 3 ? std::optional(bits) : std::nullopt;
}

std::optional<Marker> read_marker(const cv::Mat& image, const Quad& quad, const MarkerFamily& family) {
    const auto bits = read_bits(image, quad, family.side);
    const auto reading = bits ? read_code(family, *bits) : std::nullopt;
    if (!reading) {
        return std::nullopt;
    }
    Marker marker{reading->number, {}};
    for (std::size_t i = 0; i < quad.size(); ++i) {
        marker.corners[i] = quad[(i + 4 - static_cast<std::size_t>(reading->turns)) % 4];
    }
    return marker;
}

}  // namespace

std::vector<Marker> find_markers(const cv::Mat& image, const MarkerFamily& family) {
    std::map<int, Marker> found;
    // Small windows find small markers, large windows those with a wide rim.
    for (const int window : {9, 25, 61}) {
        constexpr double contrast = 7;
        cv::Mat dark;
        cv::adaptiveThreshold(image, dark, 255, cv::ADAPTIVE_THRESH_MEAN_C, cv::THRESH_BINARY_INV, window, contrast);
        std::vector<std::vector<cv::Point>> contours;
        cv::findContours(dark, contours, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
        for (const auto& contour : contours) {
            const auto quad = quad_of(contour);
            const auto marker = quad ? read_marker(image, *quad, family) : std::nullopt;
            if (!marker) {
                continue;
            }
            // The rim has an inner edge, too; the outer one is wanted.
            const auto known = found.find(marker->number);
            if (known == found.end() || area(known->second.corners) < area(marker->corners)) {
                found[marker->number] = *marker;
            }
        }
    }
    std::vector<Marker> list;
    list.reserve(found.size());
    for (const auto& [number, marker] : found) {
        list.push_back(marker);
    }
    return list;
}

}  // namespace disparityd::calibration
