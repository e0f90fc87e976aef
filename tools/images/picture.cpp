// SPDX-License-Identifier: Apache-2.0
#include "tools/images/picture.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "tools/images/colour_map.h"

namespace disparityd::images {

ColourScale whole_range(DisparityRange range) {
    return {static_cast<double>(range.first), static_cast<double>(range.first + range.count - 1)};
}

ColourScale colour_scale(const DisparityMap& map, ColourRange colours) {
    return colours == ColourRange::frame ? fitted(map) : whole_range(map.range);
}

ColourScale fitted(const DisparityMap& map) {
    std::vector<std::int16_t> valid;
    for (int y = 0; y < map.d16.height; ++y) {
        std::copy_if(map.d16.row(y), map.d16.row(y) + map.d16.width, std::back_inserter(valid),
                     [&](std::int16_t d16) { return d16 != map.invalid(); });
    }
    if (valid.empty()) {
        return whole_range(map.range);
    }
    std::sort(valid.begin(), valid.end());
    const std::size_t outliers = valid.size() / 200;
    const double low = std::floor(valid[outliers] / 16.0);
    const double high = std::ceil(valid[valid.size() - 1 - outliers] / 16.0);
    return {low, std::max(high, low + 1)};
}

cv::Mat grey_view(Plane<const std::uint8_t> plane) {
    return {plane.height, plane.width, CV_8UC1, const_cast<std::uint8_t*>(plane.data),
            static_cast<std::size_t>(plane.stride)};
}

cv::Mat colour_view(Plane<const std::uint8_t> plane) {
    return {plane.height, plane.width / 3, CV_8UC3, const_cast<std::uint8_t*>(plane.data),
            static_cast<std::size_t>(plane.stride)};
}

cv::Mat depth_view(Plane<const std::uint16_t> plane) {
    return {plane.height, plane.width, CV_16UC1, const_cast<std::uint16_t*>(plane.data),
            static_cast<std::size_t>(plane.stride) * sizeof(std::uint16_t)};
}

cv::Mat colour_disparity(const FloatMap& map, const ColourScale& scale) {
    cv::Mat result(map.height, map.width, CV_8UC3);
    for (int y = 0; y < map.height; ++y) {
        auto* row = result.ptr<cv::Vec3b>(y);
        for (int x = 0; x < map.width; ++x) {
            const float value = map.at(x, y);
            row[x] = std::isfinite(value) ? colour_of(static_cast<double>(value), scale) : rejected_colour;
        }
    }
    return result;
}

cv::Mat colour_disparity(const DisparityMap& map, const ColourScale& scale) {
    return colour_disparity(to_float(map), scale);
}

cv::Mat picture(const cv::Mat& left, const DisparityMap& map, const ColourScale& scale, const Metric& metric) {
    std::vector<cv::Mat> parts;
    if (left.channels() == 3) {
        parts.push_back(left);
    } else if (!left.empty()) {
        cv::cvtColor(left, parts.emplace_back(), cv::COLOR_GRAY2BGR);
    }
    parts.push_back(colour_disparity(map, scale));
    parts.push_back(scale_bar(map.d16.height, scale, metric));
    return side_by_side(parts);
}

void mark_synthetic(cv::Mat& picture) {
    constexpr const char* text = "synthetic";
    constexpr int font = cv::FONT_HERSHEY_SIMPLEX;
    constexpr double scale = 0.4;
    constexpr int margin = 3;
    int below = 0;  // the line on which letters stand
    const cv::Size size = cv::getTextSize(text, font, scale, 1, &below);
    const cv::Rect ground(0, 0, size.width + 2 * margin, size.height + below + 2 * margin);
    if (picture.cols < ground.width || picture.rows < ground.height) {
        return;
    }
    picture(ground).setTo(cv::Scalar(0, 0, 0));
    cv::putText(picture, text, {margin, margin + size.height}, font, scale, cv::Scalar(255, 255, 255), 1, cv::LINE_AA);
}

}  // namespace disparityd::images
