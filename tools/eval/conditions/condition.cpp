// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/conditions/condition.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <opencv2/imgproc.hpp>

#include "base/number_text.h"

namespace disparityd::eval {
namespace {

/// Values of mean 0 and sigma 1.
cv::Mat unit_noise(int rows, int columns, bool shared, std::uint32_t seed) {
    cv::Mat noise(rows, columns, CV_32FC1);
    Draws draws(seed);
    for (int y = 0; y < rows; ++y) {
        auto* row = noise.ptr<float>(y);
        std::generate(row, row + columns, [&draws] { return static_cast<float>(draws.gaussian()); });
    }
    if (shared) {
        cv::blur(noise, noise, {3, 3});
        noise *= 3;  // the mean of nine values has a third of their sigma
    }
    return noise;
}

cv::Mat exposed(const cv::Mat& light, const Sensor& sensor, std::uint32_t seed) {
    const cv::Mat noise = unit_noise(light.rows, light.cols, sensor.shared, seed);
    cv::Mat image(light.rows, light.cols, CV_8UC1);
    for (int y = 0; y < light.rows; ++y) {
        const auto* level = light.ptr<float>(y);
        const auto* random = noise.ptr<float>(y);
        auto* pixel = image.ptr<std::uint8_t>(y);
        for (int x = 0; x < light.cols; ++x) {
            const double sigma = std::sqrt(sensor.read * sensor.read + sensor.shot * std::max(level[x], 0.0F));
            const double value = level[x] + sigma * random[x];
            pixel[x] = static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
        }
    }
    return image;
}

}  // namespace

std::string_view to_string(Strength strength) {
    constexpr std::array<std::string_view, 3> names{"low", "middle", "high"};
    return names[static_cast<std::size_t>(strength)];
}

std::vector<const Condition*> conditions_named(const std::vector<std::string>& names) {
    std::string all;
    for (const Condition& condition : conditions()) {
        all += (all.empty() ? "" : ", ") + std::string(condition.name);
    }
    for (const std::string& name : names) {
        if (std::none_of(conditions().begin(), conditions().end(), [&](const auto& one) { return one.name == name; })) {
            throw std::invalid_argument("--condition: found '" + name + "', allowed: " + all);
        }
    }
    std::vector<const Condition*> chosen;
    for (const Condition& condition : conditions()) {
        if (names.empty() || std::find(names.begin(), names.end(), condition.name) != names.end()) {
            chosen.push_back(&condition);
        }
    }
    return chosen;
}

std::string strength_text(const Condition& condition, Strength strength) {
    const auto number = [](double value) { return base::number_text(value); };
    const auto [from, to] = condition.range(strength);
    return std::string(to_string(strength)) + ", " + number(from) + (from == to ? "" : " to " + number(to)) + ' ' +
           std::string(condition.unit);
}

EyePair exposed(const Light& light, std::uint32_t seed) {
    return {exposed(light.eyes[0], light.sensor, seed * 2), exposed(light.eyes[1], light.sensor, seed * 2 + 1)};
}

}  // namespace disparityd::eval
