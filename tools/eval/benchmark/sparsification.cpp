// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/benchmark/sparsification.h"

#include <algorithm>
#include <functional>
#include <numeric>

namespace disparityd::eval {
namespace {

/// Pixels that are removed together.
struct Group {
    double pixels = 0;
    double error = 0;  ///< sum
};

std::vector<Group> by_confidence(const std::vector<double>& errors, const std::vector<float>& confidences) {
    std::vector<std::size_t> order(errors.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return confidences[a] < confidences[b]; });
    std::vector<Group> groups;
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i == 0 || confidences[order[i]] != confidences[order[i - 1]]) {
            groups.emplace_back();
        }
        groups.back().pixels += 1;
        groups.back().error += errors[order[i]];
    }
    return groups;
}

std::vector<Group> by_error(std::vector<double> errors) {
    std::sort(errors.begin(), errors.end(), std::greater<>());
    std::vector<Group> groups;
    groups.reserve(errors.size());
    for (const double error : errors) {
        groups.push_back({1, error});
    }
    return groups;
}

/// The mean error of what is left, in the order of the groups.
std::array<double, Sparsification::steps> curve_of(const std::vector<Group>& groups, double pixels, double error) {
    std::array<double, Sparsification::steps> curve{};
    std::size_t next = 0;
    Group removed;  // the groups before `next`
    for (std::size_t step = 0; step < curve.size(); ++step) {
        const double to_remove = pixels * static_cast<double>(step) / static_cast<double>(curve.size());
        while (next < groups.size() && removed.pixels + groups[next].pixels <= to_remove) {
            removed.pixels += groups[next].pixels;
            removed.error += groups[next].error;
            ++next;
        }
        const double rest = next < groups.size() ? (to_remove - removed.pixels) / groups[next].pixels : 0;
        const double of_rest = next < groups.size() ? rest * groups[next].error : 0;
        // Rounding leaves less than nothing where all that is left has no error.
        curve[step] = std::max(0.0, (error - removed.error - of_rest) / (pixels - to_remove));
    }
    return curve;
}

}  // namespace

Sparsification sparsification(const std::vector<double>& errors, const std::vector<float>& confidences) {
    const auto pixels = static_cast<double>(errors.size());
    const double error = std::accumulate(errors.begin(), errors.end(), 0.0);
    return {curve_of(by_confidence(errors, confidences), pixels, error), curve_of(by_error(errors), pixels, error)};
}

double Sparsification::area_px() const {
    double area = 0;
    for (std::size_t step = 0; step < steps; ++step) {
        area += (error_px[step] - best_px[step]) / static_cast<double>(steps);
    }
    return area;
}

double Sparsification::relative_area() const {
    return error_px[0] > 0 ? area_px() / error_px[0] : 0;
}

}  // namespace disparityd::eval
