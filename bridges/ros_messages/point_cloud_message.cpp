// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros_messages/point_cloud_message.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "bridges/frames/planes.h"
#include "bridges/ros_messages/depth_metres.h"
#include "bridges/ros_messages/message_header.h"
#include "clients/cpp/nearest_pixel.h"

namespace disparityd::ros {
namespace {

using disparity::Frame;
using disparity::PlaneData;
using disparity::Product;
using frames::whole_plane;

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

using Point = std::array<float, 4>;

/// Returns x, y, z of a pixel, and 0.
Point place_of(const Frame& frame, const Depths& depths, std::size_t pixel) {
    const float z = depths.metres[pixel];
    if (!std::isfinite(z)) {
        constexpr float nowhere = std::numeric_limits<float>::quiet_NaN();
        return {nowhere, nowhere, nowhere, 0};
    }
    const std::size_t whole_rows = pixel / depths.width;
    const auto column = static_cast<double>(pixel % depths.width);
    const auto row = static_cast<double>(whole_rows);
    return {static_cast<float>((column + frame.region_x - frame.cx) * z / frame.f),
            static_cast<float>((row + frame.region_y - frame.cy) * z / frame.f), z, 0};
}

bool is_in(const CloudBox& box, const Point& point) {
    const double ahead = point[2];
    const double left = -point[0];
    const double up = -point[1];
    return ahead >= box.ahead_from && ahead <= box.ahead_to && left >= box.left_from && left <= box.left_to &&
           up >= box.up_from && up <= box.up_to;
}

/// Knows in which cubes there is a point already.
class Voxels {
public:
    explicit Voxels(double side_m) : side_m_(side_m) {}

    /// Returns whether the point is the first one in its cube.
    bool add(const Point& point) {
        std::uint64_t cube = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            // 21 bits for each axis are more than a million cubes to either side.
            const double place = std::clamp(std::floor(point[axis] / side_m_), -1'000'000.0, 1'000'000.0);
            cube = cube << 21 | (static_cast<std::uint64_t>(static_cast<std::int64_t>(place)) & 0x1fffffU);
        }
        return taken_.insert(cube).second;
    }

private:
    double side_m_;
    std::unordered_set<std::uint64_t> taken_;
};

/// Returns the pixels that are points of a packed cloud.
std::vector<std::size_t> packed(const Frame& frame, const Depths& depths, const CloudSettings& settings,
                                const std::vector<std::size_t>& pixels) {
    std::vector<std::size_t> kept;
    Voxels voxels(settings.voxel_m);
    for (const std::size_t pixel : pixels) {
        const Point point = place_of(frame, depths, pixel);
        if (std::isfinite(point[2]) && (!settings.box || is_in(*settings.box, point)) &&
            (settings.voxel_m <= 0 || voxels.add(point))) {
            kept.push_back(pixel);
        }
    }
    return kept;
}

std::vector<std::size_t> thinned(const Depths& depths, std::uint32_t step) {
    std::vector<std::size_t> pixels;
    pixels.reserve(parts(depths.width, step) * parts(depths.height, step));
    const auto depth_at = [&](std::size_t pixel) { return depths.metres[pixel]; };
    disparity::for_each_nearest(depths.width, depths.height, step, depth_at,
                                [&](std::size_t pixel) { pixels.push_back(pixel); });
    return pixels;
}

}  // namespace

std::optional<std::string> point_cloud(const Frame& frame, const CloudSettings& settings, const FrameNames& names) {
    constexpr std::array order{Product::disparity, Product::depth};
    const std::optional<Depths> depths = frame.f > 0 ? depths_of(frame, order) : std::nullopt;
    if (!depths) {
        return std::nullopt;
    }
    const Paint paint = paint_of(frame, *depths);
    const std::uint32_t step = step_for(*depths, settings.most_points);
    std::vector<std::size_t> pixels = thinned(*depths, step);
    auto width = static_cast<std::uint32_t>(parts(depths->width, step));
    auto height = static_cast<std::uint32_t>(parts(depths->height, step));
    if (settings.is_packed()) {
        pixels = packed(frame, *depths, settings, pixels);
        width = static_cast<std::uint32_t>(pixels.size());
        height = 1;
    }
    const std::uint32_t floats = paint.plane != nullptr ? 4 : 3;
    const std::uint32_t point_bytes = floats * sizeof(float);

    CdrWriter cdr(std::size_t{point_bytes} * pixels.size() + 256);
    write_header(cdr, frame.realtime_ns, names.left);
    cdr.u32(height).u32(width);
    write_fields(cdr, paint);
    cdr.boolean(false).u32(point_bytes).u32(point_bytes * width);  // little endian
    std::uint8_t* out = cdr.u8_room(point_bytes * pixels.size()).data();
    for (const std::size_t pixel : pixels) {
        Point point = place_of(frame, *depths, pixel);
        point[3] = paint.plane != nullptr ? paint.value(pixel) : 0;
        std::memcpy(out, point.data(), point_bytes);
        out += point_bytes;
    }
    cdr.boolean(settings.is_packed());  // dense: each point has a place
    return cdr.take();
}

}  // namespace disparityd::ros
