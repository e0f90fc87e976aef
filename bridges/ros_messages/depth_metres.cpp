// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros_messages/depth_metres.h"

#include <cstring>
#include <limits>

#include "bridges/frames/planes.h"

namespace disparityd::ros {
namespace {

using disparity::Frame;
using disparity::PlaneData;
using disparity::Product;
using frames::whole_plane;

constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
constexpr float too_far = std::numeric_limits<float>::infinity();

/// Calls a function with each number of 16 bits.
template <typename Number, typename Function>
void for_each(std::span<const std::uint8_t> bytes, Function function) {
    static_assert(sizeof(Number) == 2);
    for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
        Number number{};
        std::memcpy(&number, &bytes[i], sizeof number);
        function(number);
    }
}

std::vector<float> metres_of_disparities(const Frame& frame, const PlaneData& plane) {
    const double fb = frame.f * frame.baseline_mm / 1000;  // px m
    std::vector<float> metres;
    metres.reserve(plane.bytes.size() / 2);
    for_each<std::int16_t>(plane.bytes, [&](std::int16_t sixteenths) {
        const double d = sixteenths / 16.0 + frame.disparity_offset;
        metres.push_back(sixteenths == frame.invalid ? unknown : d <= 0 ? too_far : static_cast<float>(fb / d));
    });
    return metres;
}

}  // namespace

std::vector<float> metres_of(std::span<const std::uint8_t> millimetres) {
    std::vector<float> metres;
    metres.reserve(millimetres.size() / 2);
    for_each<std::uint16_t>(millimetres, [&](std::uint16_t mm) {
        metres.push_back(mm == 0 ? unknown : mm == 65535 ? too_far : static_cast<float>(mm) / 1000.0F);
    });
    return metres;
}

std::optional<Depths> depths_of(const Frame& frame, std::span<const Product> order) {
    for (const Product product : order) {
        const PlaneData* plane = whole_plane(frame, product);
        if (plane != nullptr && product == Product::depth) {
            return Depths{plane->width, plane->height, metres_of(plane->bytes)};
        }
        if (plane != nullptr && product == Product::disparity && frame.f > 0 && frame.baseline_mm > 0) {
            return Depths{plane->width, plane->height, metres_of_disparities(frame, *plane)};
        }
    }
    return std::nullopt;
}

}  // namespace disparityd::ros
