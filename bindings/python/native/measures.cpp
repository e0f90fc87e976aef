// SPDX-License-Identifier: Apache-2.0
#include "bindings/python/native/measures.h"

#include <limits>

namespace disparityd::bindings {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr double steps_of_px = 16;

}  // namespace

void to_px(const std::int16_t* disparity, std::size_t count, std::int16_t invalid, float* px) {
    for (std::size_t i = 0; i < count; ++i) {
        px[i] = disparity[i] == invalid ? nan : static_cast<float>(disparity[i]) / static_cast<float>(steps_of_px);
    }
}

void to_metres(const std::int16_t* disparity, std::size_t count, std::int16_t invalid, const Geometry& geometry,
               float* metres) {
    for (std::size_t i = 0; i < count; ++i) {
        const double shift = disparity[i] / steps_of_px + geometry.offset;
        const float z = shift > 0 ? static_cast<float>(geometry.focal_baseline / shift) : infinity;
        metres[i] = disparity[i] == invalid ? nan : z;
    }
}

void to_metre_errors(const std::int16_t* disparity, const std::uint8_t* confidence, std::size_t count,
                     const Geometry& geometry, double sigma_px, float* errors) {
    for (std::size_t i = 0; i < count; ++i) {
        const double shift = disparity[i] / steps_of_px + geometry.offset;
        const float error =
            shift > 0 ? static_cast<float>(geometry.focal_baseline * sigma_px / (shift * shift)) : infinity;
        errors[i] = confidence[i] == 0 ? nan : error;
    }
}

}  // namespace disparityd::bindings
