// SPDX-License-Identifier: Apache-2.0
#include "tools/images/colour_map.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include <opencv2/imgproc.hpp>

namespace disparityd::images {
namespace {

constexpr int font = cv::FONT_HERSHEY_SIMPLEX;
constexpr const char* rejected_text = "rejected";
const cv::Scalar paper(24, 24, 24);
const cv::Scalar ink(235, 235, 235);

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

/// The size of the text follows from the height of the picture; what is too small to read is not written.
class Lettering {
public:
    explicit Lettering(int height) : scale_(std::clamp(height / 1000.0, 0.4, 1.2)), height_(size("0000").height) {}

    int height() const { return height_; }
    int margin() const { return height_ + 4; }
    int swatch() const { return 2 * height_; }
    int width(const std::string& text) const { return size(text).width; }

    /// `y` is the middle of the text.
    void put(cv::Mat& image, const std::string& text, int x, int y) const {
        cv::putText(image, text, {x, y + height_ / 2}, font, scale_, ink, 1, cv::LINE_AA);
    }

private:
    cv::Size size(const std::string& text) const { return cv::getTextSize(text, font, scale_, 1, nullptr); }

    double scale_;
    int height_;
};

/// A label of the scale: px, and m where that is known.
struct Label {
    double disparity;
    std::string px;
    std::string metres;
};

std::vector<Label> labels_of(const ColourScale& scale, const Metric& metric, int most) {
    std::vector<Label> labels;
    const double step = label_step(scale, most);
    for (double d = std::ceil(scale.low / step) * step; d <= scale.high; d += step) {
        labels.push_back({d, number(d, "%.0f"), metric.known() ? distance(metric.metres(d)) : ""});
    }
    return labels;
}

int widest(const Lettering& letters, const std::vector<std::string>& texts) {
    int width = 0;
    for (const std::string& text : texts) {
        width = std::max(width, letters.width(text));
    }
    return width;
}

void draw_swatch(cv::Mat& image, const Lettering& letters, int middle, const cv::Vec3b& colour) {
    const int side = letters.swatch();
    const cv::Rect place(letters.margin(), middle - side / 3, side, 2 * side / 3);
    cv::rectangle(image, place, cv::Scalar(colour), cv::FILLED);
    cv::rectangle(image, place, ink);  // a black one would not be seen
}

}  // namespace

cv::Mat scale_bar(int height, const ColourScale& scale, const Metric& metric) {
    const Lettering letters(height);
    // Near is on top. A line of text is kept free above for the units, one below for rejected pixels.
    const int top = letters.margin() + 2 * letters.height();
    const int below = letters.margin() + 3 * letters.height();
    const int label_height = 5 * letters.height() / 2;
    constexpr int least_labels = 4;
    height = std::max(height, top + least_labels * label_height + below);
    const int bottom = height - below;

    const std::vector<Label> labels = labels_of(scale, metric, (bottom - top) / label_height);
    std::vector<std::string> px{"px", "000"};
    std::vector<std::string> metres{"m", "00.0"};
    for (const Label& label : labels) {
        px.push_back(label.px);
        metres.push_back(label.metres);
    }
    const int px_column = 2 * letters.margin() + letters.swatch();
    const int m_column = px_column + widest(letters, px) + letters.margin();
    const int numbers = metric.known() ? m_column + widest(letters, metres) : m_column - letters.margin();
    const int width = std::max(numbers, px_column + letters.width(rejected_text)) + letters.margin();

    cv::Mat result(height, width, CV_8UC3, paper);
    for (int y = top; y <= bottom; ++y) {
        const double disparity = scale.low + (scale.high - scale.low) * (bottom - y) / (bottom - top);
        result(cv::Rect(letters.margin(), y, letters.swatch(), 1)).setTo(cv::Scalar(colour_of(disparity, scale)));
    }
    letters.put(result, "px", px_column, letters.margin());
    if (metric.known()) {
        letters.put(result, "m", m_column, letters.margin());
    }
    for (const Label& label : labels) {
        const int y =
            bottom -
            static_cast<int>(std::lround((label.disparity - scale.low) / (scale.high - scale.low) * (bottom - top)));
        cv::line(result, {letters.margin() + letters.swatch(), y}, {px_column - 4, y}, ink);
        letters.put(result, label.px, px_column, y);
        letters.put(result, label.metres, m_column, y);
    }
    draw_swatch(result, letters, height - letters.margin(), rejected_colour);
    letters.put(result, rejected_text, px_column, height - letters.margin());
    return result;
}

cv::Mat colour_legend(int height, const std::string& heading, const std::vector<LegendRow>& rows) {
    const Lettering letters(height);
    const int row_height = 5 * letters.height() / 2;
    const int text_column = 2 * letters.margin() + letters.swatch();
    std::vector<std::string> meanings;
    for (const LegendRow& row : rows) {
        meanings.push_back(row.meaning);
    }
    const int width = std::max(text_column + widest(letters, meanings), letters.margin() + letters.width(heading));
    const int needed = 2 * letters.margin() + static_cast<int>(rows.size()) * row_height;
    cv::Mat result(std::max(height, needed), width + letters.margin(), CV_8UC3, paper);
    int y = letters.margin();
    letters.put(result, heading, letters.margin(), y);
    for (const LegendRow& row : rows) {
        y += row_height;
        draw_swatch(result, letters, y, row.colour);
        letters.put(result, row.meaning, text_column, y);
    }
    return result;
}

cv::Mat side_by_side(const std::vector<cv::Mat>& parts) {
    cv::Size size;
    for (const cv::Mat& part : parts) {
        size = {size.width + part.cols, std::max(size.height, part.rows)};
    }
    cv::Mat result(size, CV_8UC3, paper);
    int x = 0;
    for (const cv::Mat& part : parts) {
        part.copyTo(result(cv::Rect(x, 0, part.cols, part.rows)));
        x += part.cols;
    }
    return result;
}

const std::array<cv::Vec3b, 256>& colour_map() {
    static const std::array<cv::Vec3b, 256> map = [] {
        std::array<std::uint8_t, 256> numbers;
        std::iota(numbers.begin(), numbers.end(), std::uint8_t{0});
        std::array<cv::Vec3b, 256> colours;
        cv::Mat made(1, 256, CV_8UC3, colours.data());
        cv::applyColorMap(cv::Mat(1, 256, CV_8UC1, numbers.data()), made, cv::COLORMAP_TURBO);
        return colours;
    }();
    return map;
}

cv::Vec3b colour_of(double disparity, const ColourScale& scale) {
    const double t = (disparity - scale.low) / (scale.high - scale.low);
    return colour_map()[static_cast<std::size_t>(std::lround(std::clamp(t, 0.0, 1.0) * 255))];
}

}  // namespace disparityd::images
