// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/confidence/reliability.h"

#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace disparityd::eval {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr int bin_size = 16;

double sum(const std::array<double, 256>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

}  // namespace

void Reliability::add(const images::FloatMap& disparity, const std::vector<std::uint8_t>& confidence,
                      const images::FloatMap& truth) {
    if (disparity.values.size() != truth.values.size() || confidence.size() != truth.values.size()) {
        throw std::invalid_argument("confidence, disparity and truth differ in size");
    }
    Reliability scene;
    for (std::size_t i = 0; i < confidence.size(); ++i) {
        if (confidence[i] != 0 && std::isfinite(truth.values[i])) {
            scene.weight[confidence[i]] += 1;
            scene.right[confidence[i]] += std::abs(disparity.values[i] - truth.values[i]) <= 1 ? 1 : 0;
        }
    }
    const double pixels = sum(scene.weight);
    for (std::size_t value = 0; pixels > 0 && value < 256; ++value) {
        weight[value] += scene.weight[value] / pixels;
        right[value] += scene.right[value] / pixels;
    }
}

void Reliability::add(const Reliability& other) {
    for (std::size_t value = 0; value < 256; ++value) {
        weight[value] += other.weight[value];
        right[value] += other.right[value];
    }
}

std::vector<ReliabilityBin> reliability_bins(const Reliability& counted) {
    const double all = sum(counted.weight);
    std::vector<ReliabilityBin> bins;
    for (int first = 0; first < 256; first += bin_size) {
        double pixels = 0;
        double right = 0;
        double says = 0;
        for (int value = first; value < first + bin_size; ++value) {
            const auto at = static_cast<std::size_t>(value);
            pixels += counted.weight[at];
            right += counted.right[at];
            says += counted.weight[at] * value / 255;
        }
        bins.push_back({first == 0 ? 1 : first, first + bin_size - 1, all > 0 ? pixels / all : nan,
                        pixels > 0 ? says / pixels : nan, pixels > 0 ? right / pixels : nan});
    }
    return bins;
}

double calibration_error(const Reliability& counted) {
    double error = nan;
    for (const ReliabilityBin& bin : reliability_bins(counted)) {
        if (bin.share > 0) {
            error = (std::isnan(error) ? 0 : error) + bin.share * std::abs(bin.says - bin.is);
        }
    }
    return error;
}

double sparsification_area(const Reliability& counted) {
    const double all = sum(counted.weight);
    if (!(all > 0)) {
        return nan;
    }
    // Steps of the removed share; pixels of equal confidence are removed in the proportion of their shares.
    constexpr int steps = 1000;
    const double wrong_at_first = 1 - sum(counted.right) / all;
    double area = 0;
    double left = 1;
    double wrong = wrong_at_first;
    std::size_t value = 0;
    double left_of_value = counted.weight[0] / all;
    for (int step = 0; step < steps; ++step) {
        const double removed = 1 - left;
        const double best = std::fmax(0, (wrong_at_first - removed) / left);
        area += (wrong / left - best) / steps;
        double to_remove = 1.0 / steps;
        while (to_remove > 0 && value < 256) {
            const double part = std::fmin(to_remove, left_of_value);
            const double pixels = counted.weight[value];
            wrong -= pixels > 0 ? part * (1 - counted.right[value] / pixels) : 0;
            to_remove -= part;
            left -= part;
            left_of_value -= part;
            if (left_of_value <= 0 && ++value < 256) {
                left_of_value = counted.weight[value] / all;
            }
        }
        if (left <= 0) {
            break;
        }
    }
    return area;
}

}  // namespace disparityd::eval
