// SPDX-License-Identifier: Apache-2.0
#include "tools/images/colour_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace disparityd::images {
namespace {

/// A colour of the OKLab space in polar form: lightness 0 .. 1, chroma, hue in degrees.
struct Oklch {
    double lightness;
    double chroma;
    double hue;
};

/// Linear sRGB; outside 0 .. 1 where a screen cannot show the colour.
std::array<double, 3> to_linear_rgb(const Oklch& colour) {
    const double angle = colour.hue * std::numbers::pi / 180;
    const double a = colour.chroma * std::cos(angle);
    const double b = colour.chroma * std::sin(angle);
    const double l = std::pow(colour.lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
    const double m = std::pow(colour.lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
    const double s = std::pow(colour.lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
    return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
            -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
            -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

bool can_be_shown(const Oklch& colour) {
    const auto rgb = to_linear_rgb(colour);
    return std::all_of(rgb.begin(), rgb.end(), [](double part) { return part >= 0 && part <= 1; });
}

double largest_chroma(double lightness, double hue, double limit) {
    double inside = 0;
    double outside = limit;
    for (int i = 0; i < 20; ++i) {
        const double middle = (inside + outside) / 2;
        (can_be_shown({lightness, middle, hue}) ? inside : outside) = middle;
    }
    return inside;
}

std::uint8_t encode(double linear) {
    const double value = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
    return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 1.0) * 255));
}

std::array<cv::Vec3b, 256> make_colour_map() {
    constexpr double darkest = 0.36, lightest = 0.93;
    constexpr double first_hue = 305, last_hue = 100;
    constexpr double most_chroma = 0.17;
    std::array<cv::Vec3b, 256> map;
    for (std::size_t i = 0; i < map.size(); ++i) {
        const double t = static_cast<double>(i) / static_cast<double>(map.size() - 1);
        Oklch colour{darkest + t * (lightest - darkest), 0, first_hue + t * (last_hue - first_hue)};
        colour.chroma = largest_chroma(colour.lightness, colour.hue, most_chroma);
        const auto rgb = to_linear_rgb(colour);
        map[i] = {encode(rgb[2]), encode(rgb[1]), encode(rgb[0])};
    }
    return map;
}

}  // namespace

const std::array<cv::Vec3b, 256>& colour_map() {
    static const std::array<cv::Vec3b, 256> map = make_colour_map();
    return map;
}

cv::Vec3b colour_of(double disparity, const ColourScale& scale) {
    const double t = (disparity - scale.low) / (scale.high - scale.low);
    return colour_map()[static_cast<std::size_t>(std::lround(std::clamp(t, 0.0, 1.0) * 255))];
}

}  // namespace disparityd::images
