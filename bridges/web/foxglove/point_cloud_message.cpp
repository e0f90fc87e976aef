// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/foxglove/point_cloud_message.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>

#include "bridges/web/foxglove/depth_metres.h"
#include "bridges/web/foxglove/message_header.h"
#include "bridges/web/frames/planes.h"
#include "clients/cpp/nearest_pixel.h"

namespace disparityd::foxglove {
namespace {

using disparity::Frame;
using disparity::PlaneData;
using disparity::Product;
using web::whole_plane;

constexpr std::uint8_t float32 = 7;  // sensor_msgs/msg/PointField

/// What a point has beside its place.
struct Paint {
    const PlaneData* plane = nullptr;  ///< nullptr: nothing

    bool colour() const { return plane->product == Product::left_colour; }
    std::string_view field() const { return colour() ? "rgb" : "intensity"; }

    /// Returns the bits of the field.
    float value(std::size_t pixel) const {
        if (!colour()) {
            return plane->bytes[pixel];
        }
        const std::uint8_t* bgr = &plane->bytes[3 * pixel];
        const std::uint32_t packed = std::uint32_t{bgr[2]} << 16 | std::uint32_t{bgr[1]} << 8 | bgr[0];
        float bits{};
        std::memcpy(&bits, &packed, sizeof bits);
        return bits;
    }
};

Paint paint_of(const Frame& frame, const Depths& depths) {
    for (const Product product : {Product::left_colour, Product::left}) {
        const PlaneData* plane = whole_plane(frame, product);
        if (plane != nullptr && plane->width == depths.width && plane->height == depths.height) {
            return {plane};
        }
    }
    return {};
}

constexpr std::uint64_t parts(std::uint32_t all, std::uint32_t step) {
    return (std::uint64_t{all} + step - 1) / step;
}

std::uint32_t step_for(const Depths& depths, std::uint32_t most_points) {
    std::uint32_t step = 1;
    while (parts(depths.width, step) * parts(depths.height, step) > std::max(1U, most_points)) {
        ++step;
    }
    return step;
}

void write_fields(CdrWriter& cdr, const Paint& paint) {
    constexpr std::array<std::string_view, 3> place{"x", "y", "z"};
    cdr.length(paint.plane != nullptr ? 4 : 3);
    std::uint32_t offset = 0;
    const auto write = [&](std::string_view name) {
        cdr.text(name).u32(offset).u8(float32).u32(1);
        offset += sizeof(float);
    };
    std::for_each(place.begin(), place.end(), write);
    if (paint.plane != nullptr) {
        write(paint.field());
    }
}

/// Writes x, y, z of a pixel.
void place_point(float* point, const Frame& frame, double column, double row, float z) {
    if (!std::isfinite(z)) {
        std::fill_n(point, 3, std::numeric_limits<float>::quiet_NaN());
        return;
    }
    point[0] = static_cast<float>((column + frame.region_x - frame.cx) * z / frame.f);
    point[1] = static_cast<float>((row + frame.region_y - frame.cy) * z / frame.f);
    point[2] = z;
}

}  // namespace

std::optional<std::string> point_cloud(const Frame& frame, std::uint32_t most_points) {
    constexpr std::array order{Product::disparity, Product::depth};
    const std::optional<Depths> depths = frame.f > 0 ? depths_of(frame, order) : std::nullopt;
    if (!depths) {
        return std::nullopt;
    }
    const Paint paint = paint_of(frame, *depths);
    const std::uint32_t step = step_for(*depths, most_points);
    const auto width = static_cast<std::uint32_t>(parts(depths->width, step));
    const auto height = static_cast<std::uint32_t>(parts(depths->height, step));
    const std::uint32_t floats = paint.plane != nullptr ? 4 : 3;
    const std::uint32_t point_bytes = floats * sizeof(float);

    CdrWriter cdr(std::size_t{point_bytes} * width * height + 256);
    write_header(cdr, frame.realtime_ns, left_frame);
    cdr.u32(height).u32(width);
    write_fields(cdr, paint);
    cdr.boolean(false).u32(point_bytes).u32(point_bytes * width);  // little endian
    std::uint8_t* out = cdr.u8_room(std::size_t{point_bytes} * width * height).data();
    const auto depth_at = [&](std::size_t pixel) { return depths->metres[pixel]; };
    disparity::for_each_nearest(depths->width, depths->height, step, depth_at, [&](std::size_t pixel) {
        std::array<float, 4> point{};
        place_point(point.data(), frame, static_cast<double>(pixel % depths->width),
                    static_cast<double>(pixel / depths->width), depths->metres[pixel]);
        point[3] = paint.plane != nullptr ? paint.value(pixel) : 0;
        std::memcpy(out, point.data(), point_bytes);
        out += point_bytes;
    });
    cdr.boolean(false);  // not dense: there are points without a place
    return cdr.take();
}

}  // namespace disparityd::foxglove
