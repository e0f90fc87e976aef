// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <vector>

#include "clients/cpp/disparity_client.hpp"
#include "clients/cpp/nearest_pixel.h"

/// Computes distances from a frame's planes, copied or borrowed. clients/python/disparity/frame.py does the same in the
/// same steps, so that both have the same bits; a test compares them.
namespace disparity {

constexpr float unknown_m = std::numeric_limits<float>::quiet_NaN();
constexpr float beyond_m = std::numeric_limits<float>::infinity();

inline bool has_metres(const FrameInfo& frame) {
    return frame.f > 0 && frame.baseline_mm > 0;
}

/// Returns millimetres of 16 bits as metres.
inline float metres_of(std::uint16_t mm) {
    return mm == 0 ? unknown_m : mm == 65535 ? beyond_m : static_cast<float>(mm) / 1000.0F;
}

/// Returns the distance of disparities in 1/16 px.
class DisparityMetres {
public:
    explicit DisparityMetres(const FrameInfo& frame)
        : fb_(frame.f * frame.baseline_mm / 1000), offset_(frame.disparity_offset), invalid_(frame.invalid) {}

    float operator()(std::int16_t sixteenths) const {
        const double d = sixteenths / 16.0 + offset_;
        return sixteenths == invalid_ ? unknown_m : d <= 0 ? beyond_m : static_cast<float>(fb_ / d);
    }

private:
    double fb_;  ///< px m
    double offset_;
    std::int32_t invalid_;
};

/// Returns the plane when it has all bytes that its size asks for, else nullptr: no daemon of ours sends another one.
template <typename AnyFrame>
auto whole_plane(const AnyFrame& frame, Product product, std::uint32_t bytes_per_pixel) {
    const auto* plane = frame.plane(product);
    const bool whole = plane != nullptr && plane->bytes_per_pixel == bytes_per_pixel &&
                       plane->bytes.size() == std::uint64_t{plane->width} * plane->height * bytes_per_pixel;
    return whole ? plane : nullptr;
}

/// Returns a number of 16 bits.
template <typename Number, typename AnyPlane>
Number number_at(const AnyPlane& plane, std::size_t pixel) {
    static_assert(sizeof(Number) == 2);
    Number number{};
    std::memcpy(&number, plane.bytes.data() + 2 * pixel, sizeof number);
    return number;
}

/// Returns a function of each number of a plane; nothing without the plane.
template <typename Number, typename AnyPlane, typename Function>
std::optional<FloatImage> image_of(const AnyPlane* plane, Function function) {
    if (plane == nullptr) {
        return std::nullopt;
    }
    FloatImage image{plane->width, plane->height, std::vector<float>(plane->bytes.size() / 2)};
    for (std::size_t i = 0; i < image.values.size(); ++i) {
        image.values[i] = function(number_at<Number>(*plane, i));
    }
    return image;
}

template <typename AnyFrame>
std::optional<FloatImage> disparity_px_of(const AnyFrame& frame) {
    return image_of<std::int16_t>(whole_plane(frame, Product::disparity, 2), [&](std::int16_t sixteenths) {
        return sixteenths == frame.invalid ? unknown_m : static_cast<float>(sixteenths) / 16.0F;
    });
}

template <typename AnyFrame>
std::optional<FloatImage> depth_m_of(const AnyFrame& frame) {
    if (auto image = image_of<std::uint16_t>(whole_plane(frame, Product::depth, 2), metres_of)) {
        return image;
    }
    return has_metres(frame) ? image_of<std::int16_t>(whole_plane(frame, Product::disparity, 2), DisparityMetres(frame))
                             : std::nullopt;
}

template <typename AnyFrame>
std::optional<FloatImage> depth_error_m_of(const AnyFrame& frame) {
    return image_of<std::uint16_t>(whole_plane(frame, Product::depth_error, 2), metres_of);
}

/// Gives points the colours of the image that the frame carries. `pixels` are where they are in it.
template <typename AnyFrame>
void paint(Points& points, const AnyFrame& frame, std::uint32_t width, std::uint32_t height,
           const std::vector<std::size_t>& pixels) {
    for (const Product product : {Product::left_colour, Product::left}) {
        const std::size_t bytes = product == Product::left_colour ? 3 : 1;
        const auto* image = whole_plane(frame, product, static_cast<std::uint32_t>(bytes));
        if (image == nullptr || image->width != width || image->height != height) {
            continue;
        }
        for (std::size_t i = 0; i < points.points.size(); ++i) {
            const std::uint8_t* blue = image->bytes.data() + pixels[i] * bytes;
            points.points[i].blue = blue[0];
            points.points[i].green = blue[bytes / 2];
            points.points[i].red = blue[bytes - 1];
        }
        points.coloured = true;
        return;
    }
}

/// `depth_at` returns the depth of a pixel in m.
template <typename AnyFrame, typename AnyPlane, typename Depth>
Points points_at(const AnyFrame& frame, const AnyPlane& plane, std::uint32_t step, Depth depth_at) {
    Points points;
    points.width = (plane.width + step - 1) / step;
    points.height = (plane.height + step - 1) / step;
    points.points.reserve(std::size_t{points.width} * points.height);
    std::vector<std::size_t> pixels;
    pixels.reserve(points.points.capacity());
    for_each_nearest(plane.width, plane.height, step, depth_at, [&](std::size_t pixel) {
        const float z = depth_at(pixel);
        Point point{unknown_m, unknown_m, unknown_m};
        if (std::isfinite(z)) {
            const auto x = static_cast<double>(pixel % plane.width);
            const auto y = static_cast<double>(pixel / plane.width);
            point.x = static_cast<float>((x + static_cast<double>(frame.region_x) - frame.cx) * z / frame.f);
            point.y = static_cast<float>((y + static_cast<double>(frame.region_y) - frame.cy) * z / frame.f);
            point.z = z;
        }
        points.points.push_back(point);
        pixels.push_back(pixel);
    });
    paint(points, frame, plane.width, plane.height, pixels);
    return points;
}

template <typename AnyFrame>
std::optional<Points> points_of(const AnyFrame& frame, std::uint32_t step) {
    step = std::clamp(step, 1U, 65536U);  // no image has a side that is longer
    if (const auto* plane = has_metres(frame) ? whole_plane(frame, Product::disparity, 2) : nullptr) {
        const DisparityMetres metres(frame);
        return points_at(frame, *plane, step,
                         [&](std::size_t i) { return metres(number_at<std::int16_t>(*plane, i)); });
    }
    if (const auto* plane = frame.f > 0 ? whole_plane(frame, Product::depth, 2) : nullptr) {
        return points_at(frame, *plane, step,
                         [&](std::size_t i) { return metres_of(number_at<std::uint16_t>(*plane, i)); });
    }
    return std::nullopt;
}

}  // namespace disparity
