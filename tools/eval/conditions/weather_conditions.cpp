// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "tools/eval/conditions/light_conditions.h"

namespace disparityd::eval {
namespace {

/// The focal length in px of the courses' camera with images of this width.
double focal_of(const cv::Mat& eye) {
    constexpr CourseCamera camera;
    return camera.f * eye.cols / camera.width;
}

double disparity_at(double metres, const cv::Mat& eye) {
    constexpr CourseCamera camera;
    return focal_of(eye) * camera.baseline_m / metres;
}

/// What covers a part of an image: its share of each pixel, 0 .. 255, and how bright it is.
void lay_over(cv::Mat& eye, const cv::Mat& shares, double bright) {
    for (int y = 0; y < eye.rows; ++y) {
        auto* pixel = eye.ptr<float>(y);
        const auto* share = shares.ptr<std::uint8_t>(y);
        for (int x = 0; x < eye.cols; ++x) {
            const float part = static_cast<float>(share[x]) / 255;
            pixel[x] += part * (static_cast<float>(bright) - pixel[x]);
        }
    }
}

cv::Point fixed_point(double x, double y, int bits) {
    return {static_cast<int>(std::lround(std::ldexp(x, bits))), static_cast<int>(std::lround(std::ldexp(y, bits)))};
}

/// Adds to `sum`, which keeps within 255, what is drawn alone.
void add_alone(cv::Mat& sum, const cv::Rect& where, const cv::Mat& drawn) {
    const cv::Rect inside = where & cv::Rect(0, 0, sum.cols, sum.rows);
    if (!inside.empty()) {
        cv::Mat part = sum(inside);
        cv::add(part, drawn(inside - where.tl()), part);
    }
}

/// A streak of a drop that falls during the exposure, thinner than a pixel where it is far away.
void add_streak(cv::Mat& shares, double x, double y, double length, double lean, double width) {
    constexpr int bits = 4;
    const int margin = static_cast<int>(std::ceil(width)) + 2;
    const cv::Rect box(
        static_cast<int>(std::floor(x - std::abs(lean) * length)) - margin, static_cast<int>(std::floor(y)) - margin,
        static_cast<int>(2 * std::abs(lean) * length) + 2 * margin + 2, static_cast<int>(length) + 2 * margin + 2);
    cv::Mat alone(box.height, box.width, CV_8UC1, cv::Scalar(0));
    const double level = 200 * std::min(1.0, width);
    cv::line(alone, fixed_point(x - box.x, y - box.y, bits),
             fixed_point(x + lean * length - box.x, y + length - box.y, bits), cv::Scalar(level),
             std::max(1, static_cast<int>(std::lround(width))), cv::LINE_AA, bits);
    add_alone(shares, box, alone);
}

/// A grain out of focus: the nearer, the larger and the fainter.
void add_grain(cv::Mat& shares, double x, double y, double radius, double level) {
    constexpr int bits = 4;
    const int reach = static_cast<int>(std::ceil(radius)) + 2;
    const cv::Rect box(static_cast<int>(std::floor(x)) - reach, static_cast<int>(std::floor(y)) - reach, 2 * reach + 1,
                       2 * reach + 1);
    cv::Mat alone(box.height, box.width, CV_8UC1, cv::Scalar(0));
    cv::circle(alone, fixed_point(x - box.x, y - box.y, bits), static_cast<int>(std::lround(radius * (1 << bits))),
               cv::Scalar(level), cv::FILLED, cv::LINE_AA, bits);
    add_alone(shares, box, alone);
}

/// The distance of something in the view's volume: the farther, the more there is.
double drawn_distance(double nearest, double farthest, Draws& draws) {
    return std::max(nearest, farthest * std::cbrt(draws.between(0, 1)));
}

using Shares = std::array<cv::Mat, 2>;

Shares no_shares(const Light& light) {
    const cv::Mat none(light.eyes[0].rows, light.eyes[0].cols, CV_8UC1, cv::Scalar(0));
    return {none.clone(), none.clone()};
}

/// Lays what both eyes see over both images, or what one of them sees over its own.
void lay_over(Light& light, const Shares& shares, double bright, bool both, Draws& draws) {
    const int only = draws.whole(0, 1);
    for (int eye = 0; eye < 2; ++eye) {
        if (both || eye == only) {
            lay_over(light.eyes[static_cast<std::size_t>(eye)], shares[static_cast<std::size_t>(eye)], bright);
        }
    }
}

void rain(Light& light, double drops, bool both, Draws& draws) {
    constexpr double fall_m = 0.08;  // 8 m/s for 10 ms
    constexpr double wide_m = 0.003;
    const double lean = draws.between(-0.3, 0.3);
    const cv::Mat& view = light.eyes[0];
    const double f = focal_of(view);
    Shares shares = no_shares(light);
    for (int i = 0; i < static_cast<int>(drops); ++i) {
        const double metres = drawn_distance(0.3, 4, draws);
        const double disparity = disparity_at(metres, view);
        const double x = draws.between(0, view.cols + disparity);
        const double length = f * fall_m / metres;
        const double y = draws.between(-length, view.rows);
        for (std::size_t eye = 0; eye < 2; ++eye) {
            add_streak(shares[eye], x - (eye == 0 ? 0 : disparity), y, length, lean, f * wide_m / metres);
        }
    }
    lay_over(light, shares, draws.between(210, 250), both, draws);
}

void dust(Light& light, double grains, bool both, Draws& draws) {
    const cv::Mat& view = light.eyes[0];
    Shares shares = no_shares(light);
    for (int i = 0; i < static_cast<int>(grains); ++i) {
        const double metres = drawn_distance(0.12, 1.2, draws);
        const double disparity = disparity_at(metres, view);
        const double x = draws.between(0, view.cols + disparity);
        const double y = draws.between(0, view.rows);
        const double radius = 1 + 1.6 / metres;
        const double level = std::clamp(500 / radius, 30.0, 180.0);
        for (std::size_t eye = 0; eye < 2; ++eye) {
            add_grain(shares[eye], x - (eye == 0 ? 0 : disparity), y, radius, level);
        }
    }
    lay_over(light, shares, draws.between(180, 230), both, draws);
}

}  // namespace

void rain_in_both(Light& light, double drops, Draws& draws) {
    rain(light, drops, true, draws);
}

void rain_in_one(Light& light, double drops, Draws& draws) {
    rain(light, drops, false, draws);
}

void dust_in_both(Light& light, double grains, Draws& draws) {
    dust(light, grains, true, draws);
}

void dust_in_one(Light& light, double grains, Draws& draws) {
    dust(light, grains, false, draws);
}

void drop_on_one(Light& light, double radius, Draws& draws) {
    cv::Mat& eye = light.eyes[static_cast<std::size_t>(draws.whole(0, 1))];
    const double middle_x = draws.between(0.15, 0.85) * eye.cols;
    const double middle_y = draws.between(0.25, 0.85) * eye.rows;
    cv::Mat blurred;
    cv::GaussianBlur(eye, blurred, {0, 0}, radius / 8);
    const cv::Mat before = eye.clone();
    for (int y = 0; y < eye.rows; ++y) {
        for (int x = 0; x < eye.cols; ++x) {
            const double away = std::hypot(x - middle_x, y - middle_y);
            const double share = std::clamp((radius - away) / 6 + 0.5, 0.0, 1.0);
            if (share > 0) {
                // A drop is a lens: it shows what is around it upside down and smaller.
                const int from_x = std::clamp(static_cast<int>(middle_x - 1.8 * (x - middle_x)), 0, eye.cols - 1);
                const int from_y = std::clamp(static_cast<int>(middle_y - 1.8 * (y - middle_y)), 0, eye.rows - 1);
                eye.at<float>(y, x) = static_cast<float>((1 - share) * before.at<float>(y, x) +
                                                         share * blurred.at<float>(from_y, from_x));
            }
        }
    }
}

void dirt_on_one(Light& light, double share, Draws& draws) {
    cv::Mat& eye = light.eyes[static_cast<std::size_t>(draws.whole(0, 1))];
    cv::Mat shares(eye.rows, eye.cols, CV_8UC1, cv::Scalar(0));
    while (cv::countNonZero(shares) < share / 100 * eye.rows * eye.cols) {
        const cv::Point middle{draws.whole(0, eye.cols - 1), draws.whole(0, eye.rows - 1)};
        const int long_side = draws.whole(12, 50);
        const int short_side = draws.whole(8, 30);
        const double turn = draws.between(0, 180);
        cv::ellipse(shares, middle, {long_side, short_side}, turn, 0, 360, cv::Scalar(draws.between(160, 245)),
                    cv::FILLED);
    }
    cv::GaussianBlur(shares, shares, {0, 0}, 5);  // dirt on a lens is out of focus
    lay_over(eye, shares, draws.between(20, 60));
}

}  // namespace disparityd::eval
