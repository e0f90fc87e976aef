// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/foxglove/image_messages.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <string_view>

#include "bridges/web/foxglove/depth_metres.h"
#include "bridges/web/foxglove/message_header.h"
#include "bridges/web/frames/jpeg.h"
#include "bridges/web/frames/planes.h"

namespace disparityd::foxglove {
namespace {

using disparity::Frame;
using disparity::PlaneData;
using disparity::Product;
using web::whole_plane;

constexpr std::size_t room_for_fields = 256;

/// Has the pixels of a sensor_msgs/msg/Image.
struct Picture {
    std::uint32_t width;
    std::uint32_t height;
    std::string_view encoding;
    std::uint32_t bytes_per_pixel;
    std::span<const std::uint8_t> data;
};

void write_image(CdrWriter& cdr, std::int64_t realtime_ns, const Picture& picture) {
    write_header(cdr, realtime_ns, left_frame);
    cdr.u32(picture.height).u32(picture.width).text(picture.encoding);
    cdr.u8(0).u32(picture.width * picture.bytes_per_pixel).u8_sequence(picture.data);  // 0: little endian
}

std::string image(std::int64_t realtime_ns, const Picture& picture) {
    CdrWriter cdr(picture.data.size() + room_for_fields);
    write_image(cdr, realtime_ns, picture);
    return cdr.take();
}

/// Returns a plane as it is.
std::optional<std::string> plane_image(const Frame& frame, Product product, std::string_view encoding) {
    const PlaneData* plane = whole_plane(frame, product);
    if (plane == nullptr) {
        return std::nullopt;
    }
    return image(frame.realtime_ns, {plane->width, plane->height, encoding, plane->bytes_per_pixel, plane->bytes});
}

std::span<const std::uint8_t> bytes_of(const std::vector<float>& numbers) {
    return {reinterpret_cast<const std::uint8_t*>(numbers.data()), numbers.size() * sizeof(float)};
}

Picture picture_of(std::uint32_t width, std::uint32_t height, const std::vector<float>& numbers) {
    return {width, height, "32FC1", sizeof(float), bytes_of(numbers)};
}

const PlaneData* left_plane(const Frame& frame) {
    const PlaneData* colour = whole_plane(frame, Product::left_colour);
    return colour != nullptr ? colour : whole_plane(frame, Product::left);
}

/// Returns the disparities in px, rejected ones less than all others.
std::vector<float> adjusted_disparities(const Frame& frame, const PlaneData& plane) {
    std::vector<float> disparities(plane.bytes.size() / 2);
    for (std::size_t i = 0; i < disparities.size(); ++i) {
        std::int16_t sixteenths = 0;
        std::memcpy(&sixteenths, &plane.bytes[2 * i], sizeof sixteenths);
        // The daemon's value of a rejected pixel is (d_min - 1) * 16: the offset makes it min_disparity - 1.
        disparities[i] = static_cast<float>(sixteenths / 16.0 + frame.disparity_offset);
    }
    return disparities;
}

}  // namespace

std::optional<std::string> left_image(const Frame& frame) {
    const PlaneData* plane = left_plane(frame);
    if (plane == nullptr) {
        return std::nullopt;
    }
    const std::string_view encoding = plane->product == Product::left_colour ? "bgr8" : "mono8";
    return image(frame.realtime_ns, {plane->width, plane->height, encoding, plane->bytes_per_pixel, plane->bytes});
}

std::optional<std::string> left_jpeg(const Frame& frame, int quality) {
    const PlaneData* plane = left_plane(frame);
    if (plane == nullptr || std::max(plane->width, plane->height) > web::most_jpeg_side) {
        return std::nullopt;
    }
    const bool grey = plane->bytes_per_pixel == 1;
    const int row = static_cast<int>(plane->width * plane->bytes_per_pixel);
    const std::string jpeg = web::jpeg_of(
        {plane->bytes.data(), static_cast<int>(plane->width), static_cast<int>(plane->height), row, grey}, quality);
    CdrWriter cdr(jpeg.size() + room_for_fields);
    write_header(cdr, frame.realtime_ns, left_frame);
    cdr.text("jpeg").u8_sequence({reinterpret_cast<const std::uint8_t*>(jpeg.data()), jpeg.size()});
    return cdr.take();
}

std::optional<std::string> confidence_image(const Frame& frame) {
    return plane_image(frame, Product::confidence, "mono8");
}

std::optional<std::string> depth_mm_image(const Frame& frame) {
    return plane_image(frame, Product::depth, "16UC1");
}

std::optional<std::string> depth_image(const Frame& frame) {
    constexpr std::array order{Product::depth, Product::disparity};
    const std::optional<Depths> depths = depths_of(frame, order);
    if (!depths) {
        return std::nullopt;
    }
    return image(frame.realtime_ns, picture_of(depths->width, depths->height, depths->metres));
}

std::optional<std::string> depth_error_image(const Frame& frame) {
    const PlaneData* plane = whole_plane(frame, Product::depth_error);
    if (plane == nullptr) {
        return std::nullopt;
    }
    return image(frame.realtime_ns, picture_of(plane->width, plane->height, metres_of(plane->bytes)));
}

std::optional<std::string> disparity_image(const Frame& frame) {
    const PlaneData* plane = whole_plane(frame, Product::disparity);
    if (plane == nullptr) {
        return std::nullopt;
    }
    const std::vector<float> disparities = adjusted_disparities(frame, *plane);
    const double first = frame.d_min + frame.disparity_offset;
    CdrWriter cdr(bytes_of(disparities).size() + 2 * room_for_fields);
    write_header(cdr, frame.realtime_ns, left_frame);
    write_image(cdr, frame.realtime_ns, picture_of(plane->width, plane->height, disparities));
    cdr.f32(static_cast<float>(frame.f)).f32(static_cast<float>(frame.baseline_mm / 1000));
    write_region(cdr, {0, 0, plane->width, plane->height});
    cdr.f32(static_cast<float>(first)).f32(static_cast<float>(first + frame.disparities - 1)).f32(1.0F / 16);
    return cdr.take();
}

}  // namespace disparityd::foxglove
