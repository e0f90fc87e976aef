// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros_messages/image_messages.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <string_view>

#include "bridges/frames/planes.h"
#include "bridges/ros_messages/depth_metres.h"
#include "bridges/ros_messages/message_header.h"
#include "formats/pictures/jpeg_writer.h"

namespace disparityd::ros {
namespace {

using disparity::Frame;
using disparity::PlaneData;
using disparity::Product;
using frames::whole_plane;

constexpr std::size_t room_for_fields = 256;

/// What a sensor_msgs/msg/Image says of its pixels.
struct Layout {
    std::uint32_t width;
    std::uint32_t height;
    std::string_view encoding;
    std::uint32_t bytes_per_pixel;

    std::size_t bytes() const { return std::size_t{width} * height * bytes_per_pixel; }
};

/// Writes all of an image but its pixels, and returns the room where the caller writes those.
std::span<std::uint8_t> write_image(CdrWriter& cdr, std::int64_t realtime_ns, std::string_view frame,
                                    const Layout& layout) {
    write_header(cdr, realtime_ns, frame);
    cdr.u32(layout.height).u32(layout.width).text(layout.encoding);
    cdr.u8(0).u32(layout.width * layout.bytes_per_pixel);  // 0: little endian
    return cdr.u8_room(layout.bytes());
}

/// Returns an image whose pixels `fill` writes.
template <typename Fill>
std::string image(const Frame& frame, const FrameNames& names, const Layout& layout, Fill fill) {
    CdrWriter cdr(layout.bytes() + room_for_fields);
    fill(write_image(cdr, frame.realtime_ns, names.left, layout));
    return cdr.take();
}

Layout layout_of(const PlaneData& plane, std::string_view encoding) {
    return {plane.width, plane.height, encoding, plane.bytes_per_pixel};
}

/// Returns a plane as it is.
std::optional<std::string> plane_image(const Frame& frame, const FrameNames& names, Product product,
                                       std::string_view encoding) {
    const PlaneData* plane = whole_plane(frame, product);
    if (plane == nullptr) {
        return std::nullopt;
    }
    return image(frame, names, layout_of(*plane, encoding), [plane](std::span<std::uint8_t> room) {
        std::copy(plane->bytes.begin(), plane->bytes.end(), room.begin());
    });
}

/// The planes are BGR; some nodes take nothing but rgb8.
std::string colour_image(const Frame& frame, const FrameNames& names, const PlaneData& plane) {
    return image(frame, names, layout_of(plane, "rgb8"), [&plane](std::span<std::uint8_t> room) {
        const std::uint8_t* const bgr = plane.bytes.data();
        std::uint8_t* const rgb = room.data();
        for (std::size_t i = 0; i + 2 < room.size(); i += 3) {
            rgb[i] = bgr[i + 2];
            rgb[i + 1] = bgr[i + 1];
            rgb[i + 2] = bgr[i];
        }
    });
}

std::optional<std::string> eye_image(const Frame& frame, const FrameNames& names, Product colour, Product grey) {
    const PlaneData* plane = whole_plane(frame, colour);
    return plane != nullptr ? colour_image(frame, names, *plane) : plane_image(frame, names, grey, "mono8");
}

void write_floats(std::span<std::uint8_t> room, const std::vector<float>& numbers) {
    std::memcpy(room.data(), numbers.data(), room.size());
}

std::string float_image(const Frame& frame, const FrameNames& names, const Depths& depths) {
    return image(frame, names, {depths.width, depths.height, "32FC1", sizeof(float)},
                 [&depths](std::span<std::uint8_t> room) { write_floats(room, depths.metres); });
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

std::optional<std::string> left_image(const Frame& frame, const FrameNames& names) {
    return eye_image(frame, names, Product::left_colour, Product::left);
}

std::optional<std::string> right_image(const Frame& frame, const FrameNames& names) {
    return eye_image(frame, names, Product::right_colour, Product::right);
}

std::optional<std::string> left_grey_image(const Frame& frame, const FrameNames& names) {
    return plane_image(frame, names, Product::left, "mono8");
}

std::optional<std::string> right_grey_image(const Frame& frame, const FrameNames& names) {
    return plane_image(frame, names, Product::right, "mono8");
}

std::optional<std::string> left_jpeg(const Frame& frame, int quality, const FrameNames& names) {
    const PlaneData* plane = left_plane(frame);
    if (plane == nullptr || std::max(plane->width, plane->height) > formats::most_jpeg_side) {
        return std::nullopt;
    }
    const bool grey = plane->bytes_per_pixel == 1;
    const int row = static_cast<int>(plane->width * plane->bytes_per_pixel);
    const std::string jpeg = formats::jpeg_of(
        {plane->bytes.data(), static_cast<int>(plane->width), static_cast<int>(plane->height), row, grey}, quality);
    CdrWriter cdr(jpeg.size() + room_for_fields);
    write_header(cdr, frame.realtime_ns, names.left);
    cdr.text("jpeg").u8_sequence({reinterpret_cast<const std::uint8_t*>(jpeg.data()), jpeg.size()});
    return cdr.take();
}

std::optional<std::string> confidence_image(const Frame& frame, const FrameNames& names) {
    return plane_image(frame, names, Product::confidence, "mono8");
}

std::optional<std::string> depth_mm_image(const Frame& frame, const FrameNames& names) {
    return plane_image(frame, names, Product::depth, "16UC1");
}

std::optional<std::string> depth_image(const Frame& frame, const FrameNames& names) {
    constexpr std::array order{Product::depth, Product::disparity};
    const std::optional<Depths> depths = depths_of(frame, order);
    return depths ? std::optional(float_image(frame, names, *depths)) : std::nullopt;
}

std::optional<std::string> depth_error_image(const Frame& frame, const FrameNames& names) {
    const PlaneData* plane = whole_plane(frame, Product::depth_error);
    if (plane == nullptr) {
        return std::nullopt;
    }
    return float_image(frame, names, {plane->width, plane->height, metres_of(plane->bytes)});
}

std::optional<std::string> disparity_image(const Frame& frame, const FrameNames& names) {
    const PlaneData* plane = whole_plane(frame, Product::disparity);
    if (plane == nullptr) {
        return std::nullopt;
    }
    const Layout layout{plane->width, plane->height, "32FC1", sizeof(float)};
    const double first = frame.d_min + frame.disparity_offset;
    CdrWriter cdr(layout.bytes() + 2 * room_for_fields);
    write_header(cdr, frame.realtime_ns, names.left);
    write_floats(write_image(cdr, frame.realtime_ns, names.left, layout), adjusted_disparities(frame, *plane));
    cdr.f32(static_cast<float>(frame.f)).f32(static_cast<float>(frame.baseline_mm / 1000));
    write_region(cdr, {0, 0, plane->width, plane->height});
    cdr.f32(static_cast<float>(first)).f32(static_cast<float>(first + frame.disparities - 1)).f32(1.0F / 16);
    return cdr.take();
}

std::string rows_image(const ImageRows& rows, std::int64_t realtime_ns, std::string_view frame) {
    const Layout layout{rows.width, rows.height, rows.encoding, rows.bytes_per_pixel};
    CdrWriter cdr(layout.bytes() + room_for_fields);
    std::uint8_t* to = write_image(cdr, realtime_ns, frame, layout).data();
    const std::size_t row_bytes = std::size_t{rows.width} * rows.bytes_per_pixel;
    for (std::uint32_t y = 0; y < rows.height; ++y, to += row_bytes) {
        std::memcpy(to, rows.data + static_cast<std::ptrdiff_t>(y) * rows.stride, row_bytes);
    }
    return cdr.take();
}

}  // namespace disparityd::ros
