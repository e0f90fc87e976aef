// SPDX-License-Identifier: Apache-2.0
#include "tools/images/picture.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "tools/images/colour_map.h"

namespace disparityd::images {
namespace {

constexpr int font = cv::FONT_HERSHEY_SIMPLEX;
const cv::Scalar paper(24, 24, 24);
const cv::Scalar ink(235, 235, 235);

cv::Vec3b colour_of(double disparity, const ColourScale& scale) {
    const double t = (disparity - scale.low) / (scale.high - scale.low);
    return colour_map()[static_cast<std::size_t>(std::lround(std::clamp(t, 0.0, 1.0) * 255))];
}

std::string number(double value, const char* format) {
    char text[32];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

std::string distance(double metres) {
    if (!std::isfinite(metres)) {
        return "far";
    }
    return number(metres, metres < 9.95 ? "%.2f" : metres < 99.5 ? "%.1f" : "%.0f");
}

/// The smallest of 1, 2, 5, 10, 20, ... that gives at most `most` labels.
double label_step(const ColourScale& scale, int most) {
    const double least = (scale.high - scale.low) / std::max(1, most);
    double step = 1;
    for (int i = 0; step < least; ++i) {
        step *= i % 3 == 1 ? 2.5 : 2;
    }
    return step;
}

/// Sizes that follow from the height of the picture.
struct Layout {
    explicit Layout(int height) : font_scale(std::clamp(height / 1000.0, 0.4, 1.2)) {
        const cv::Size text = cv::getTextSize("0000", font, font_scale, 1, nullptr);
        text_height = text.height;
        column = text.width + text.height;
        margin = text.height + 4;
        bar = 2 * text.height;
    }
    double font_scale;
    int text_height;
    int column;
    int margin;
    int bar;
};

void put(cv::Mat& image, const std::string& text, int x, int y, const Layout& layout) {
    cv::putText(image, text, {x, y}, font, layout.font_scale, ink, 1, cv::LINE_AA);
}

}  // namespace

ColourScale whole_range(DisparityRange range) {
    return {static_cast<double>(range.first), static_cast<double>(range.first + range.count - 1)};
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

cv::Mat colour_disparity(const DisparityMap& map, const ColourScale& scale) {
    cv::Mat result(map.d16.height, map.d16.width, CV_8UC3);
    for (int y = 0; y < map.d16.height; ++y) {
        auto* row = result.ptr<cv::Vec3b>(y);
        for (int x = 0; x < map.d16.width; ++x) {
            const std::int16_t d16 = map.d16.at(x, y);
            row[x] = d16 == map.invalid() ? cv::Vec3b(0, 0, 0) : colour_of(d16 / 16.0, scale);
        }
    }
    return result;
}

cv::Mat scale_bar(int height, const ColourScale& scale, const Metric& metric) {
    const Layout layout(height);
    const int px_column = 2 * layout.margin + layout.bar;
    const int m_column = px_column + layout.column;
    cv::Mat result(height, metric.known() ? m_column + layout.column : m_column, CV_8UC3, paper);

    // Near is on top; a line of text is kept free for the units.
    const int top = layout.margin + 2 * layout.text_height;
    const int bottom = std::max(top + 1, height - layout.margin);
    const auto y_of = [&](double disparity) {
        return bottom -
               static_cast<int>(std::lround((disparity - scale.low) / (scale.high - scale.low) * (bottom - top)));
    };
    for (int y = std::max(0, top); y <= bottom && y < height; ++y) {
        const double disparity = scale.low + (scale.high - scale.low) * (bottom - y) / (bottom - top);
        result(cv::Rect(layout.margin, y, layout.bar, 1)).setTo(cv::Scalar(colour_of(disparity, scale)));
    }
    put(result, "px", px_column, layout.margin, layout);
    if (metric.known()) {
        put(result, "m", m_column, layout.margin, layout);
    }
    const double step = label_step(scale, (bottom - top) / (3 * layout.text_height));
    for (double d = std::ceil(scale.low / step) * step; d <= scale.high; d += step) {
        const int y = y_of(d);
        cv::line(result, {layout.margin + layout.bar, y}, {px_column - 4, y}, ink);
        put(result, number(d, "%.0f"), px_column, y + layout.text_height / 2, layout);
        if (metric.known()) {
            put(result, distance(metric.metres(d)), m_column, y + layout.text_height / 2, layout);
        }
    }
    return result;
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
    cv::Mat result;
    cv::hconcat(parts, result);
    return result;
}

}  // namespace disparityd::images
