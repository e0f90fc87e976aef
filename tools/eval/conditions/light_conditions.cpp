// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/conditions/light_conditions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

namespace disparityd::eval {
namespace {

/// One of the two eyes, by chance.
cv::Mat& one_eye(Light& light, Draws& draws) {
    return light.eyes[static_cast<std::size_t>(draws.whole(0, 1))];
}

/// Multiplies each pixel by factor(x, y).
template <typename Factor>
void scale(cv::Mat& image, Factor factor) {
    for (int y = 0; y < image.rows; ++y) {
        auto* row = image.ptr<float>(y);
        for (int x = 0; x < image.cols; ++x) {
            row[x] *= static_cast<float>(factor(x, y));
        }
    }
}

/// Adds level(x, y) to each pixel.
template <typename Level>
void add(cv::Mat& image, Level level) {
    for (int y = 0; y < image.rows; ++y) {
        auto* row = image.ptr<float>(y);
        for (int x = 0; x < image.cols; ++x) {
            row[x] += static_cast<float>(level(x, y));
        }
    }
}

/// 1 inside, 0 outside, with an edge of `soft` px.
double disc(double distance, double radius, double soft) {
    return std::clamp((radius - distance) / soft + 0.5, 0.0, 1.0);
}

void set_noise(Light& light, double sigma, bool shared) {
    // Two thirds of the variance are of the light itself, at this level.
    constexpr double level = 120;
    light.sensor = {sigma * std::sqrt(1 / 3.0), sigma * sigma * 2 / 3 / level, shared};
}

/// A line of `length` px whose weights sum up to 1.
cv::Mat line_kernel(double length, double angle) {
    const int half = static_cast<int>(std::ceil(length / 2));
    cv::Mat kernel(2 * half + 1, 2 * half + 1, CV_32FC1, cv::Scalar(0));
    const int steps = static_cast<int>(8 * length);
    for (int i = 0; i <= steps; ++i) {
        const double at = length * (static_cast<double>(i) / steps - 0.5);
        const double x = half + at * std::cos(angle);
        const double y = half + at * std::sin(angle);
        const int left = std::min(static_cast<int>(x), 2 * half - 1);
        const int top = std::min(static_cast<int>(y), 2 * half - 1);
        for (int corner = 0; corner < 4; ++corner) {
            const int column = left + corner % 2;
            const int row = top + corner / 2;
            kernel.at<float>(row, column) +=
                static_cast<float>((1 - std::abs(x - column)) * (1 - std::abs(y - row)) / (steps + 1));
        }
    }
    return kernel;
}

}  // namespace

void add_noise(Light& light, double sigma, Draws& /*draws*/) {
    set_noise(light, sigma, false);
}

void add_shared_noise(Light& light, double sigma, Draws& /*draws*/) {
    set_noise(light, sigma, true);
}

void dim(Light& light, double share, Draws& /*draws*/) {
    for (cv::Mat& eye : light.eyes) {
        eye *= share / 100;
    }
    light.sensor.shot = 0.05;
}

void overexpose(Light& light, double share, Draws& /*draws*/) {
    for (cv::Mat& eye : light.eyes) {
        eye *= share / 100;
    }
}

void underexpose(Light& light, double share, Draws& /*draws*/) {
    constexpr double black = 10;
    for (cv::Mat& eye : light.eyes) {
        eye = eye * (share / 100) - black;
    }
}

void blur_motion(Light& light, double length, Draws& draws) {
    const bool bump = draws.between(0, 1) < 0.25;
    const double angle = (bump ? std::numbers::pi / 2 : 0) + draws.between(-0.3, 0.3);
    const cv::Mat kernel = line_kernel(length, angle);
    for (cv::Mat& eye : light.eyes) {
        cv::filter2D(eye, eye, -1, kernel, {-1, -1}, 0, cv::BORDER_REPLICATE);
    }
}

void add_glare(Light& light, double veil, Draws& draws) {
    // What is far away has the same place in both eyes.
    const double x_of = draws.between(0.1, 0.9) * light.eyes[0].cols;
    const double y_of = draws.between(0.05, 0.45) * light.eyes[0].rows;
    const double core = draws.between(8, 20);
    const double reach = draws.between(80, 160);
    for (cv::Mat& eye : light.eyes) {
        const double level = veil * draws.between(0.8, 1.2);
        add(eye, [&](int x, int y) {
            const double distance = std::hypot(x - x_of, y - y_of);
            return level * std::exp(-distance / reach) + 400 * disc(distance, core, 4);
        });
    }
}

void add_flare(Light& light, double level, Draws& draws) {
    const double middle_x = light.eyes[0].cols / 2.0;
    const double middle_y = light.eyes[0].rows / 2.0;
    const double sun_x = draws.between(-0.9, 0.9) * middle_x;
    const double sun_y = draws.between(-0.9, -0.3) * middle_y;
    constexpr int ghosts = 6;
    for (int i = 0; i < ghosts; ++i) {
        const double along = draws.between(-1.2, 0.9);
        const double radius = draws.between(8, 45);
        const double bright = level * draws.between(0.5, 1);
        for (cv::Mat& eye : light.eyes) {
            // No two lenses are mounted alike.
            const double x_of = middle_x + along * sun_x + draws.between(-12, 12);
            const double y_of = middle_y + along * sun_y + draws.between(-6, 6);
            add(eye, [&](int x, int y) {
                const double distance = std::hypot(x - x_of, y - y_of);
                return bright * disc(distance, radius, 3) * (distance > radius - 3 ? 1 : 0.7);
            });
        }
    }
}

void darken_corners(Light& light, double loss, Draws& draws) {
    for (cv::Mat& eye : light.eyes) {
        const double middle_x = eye.cols / 2.0 + draws.between(-15, 15);
        const double middle_y = eye.rows / 2.0 + draws.between(-15, 15);
        const double corner = std::hypot(eye.cols / 2.0, eye.rows / 2.0);
        scale(eye, [&](int x, int y) {
            const double part = std::hypot(x - middle_x, y - middle_y) / corner;
            return std::max(0.0, 1 - loss / 100 * part * part);
        });
    }
}

void expose_unequally(Light& light, double share, Draws& draws) {
    one_eye(light, draws) *= share / 100;
}

void cover_one(Light& light, double share, Draws& draws) {
    cv::Mat& eye = one_eye(light, draws);
    const bool from_left = draws.whole(0, 1) == 0;
    const double covered = share / 100 * eye.cols;
    constexpr double dark = 0.03;
    constexpr double soft = 20;
    scale(eye, [&](int x, int /*y*/) {
        const double from_edge = from_left ? x : eye.cols - 1 - x;
        return share >= 100 ? dark : 1 - (1 - dark) * disc(from_edge, covered, soft);
    });
}

}  // namespace disparityd::eval
