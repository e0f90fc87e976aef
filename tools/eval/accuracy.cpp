// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/accuracy.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace disparityd::eval {
namespace {

/// Counts over one set of pixels.
struct Tally {
    std::size_t judged = 0;
    std::size_t bad1 = 0;
    std::size_t bad2 = 0;
    std::size_t d1 = 0;
    std::size_t valid = 0;
    std::size_t near = 0;

    void add(float disparity, float truth) {
        const bool has_disparity = std::isfinite(disparity);
        const float error = has_disparity ? std::abs(disparity - truth) : std::numeric_limits<float>::infinity();
        ++judged;
        valid += has_disparity ? 1U : 0U;
        bad1 += error > 1.0F ? 1U : 0U;
        bad2 += error > 2.0F ? 1U : 0U;
        d1 += is_d1_outlier(error, truth) ? 1U : 0U;
        near += has_disparity && disparity > truth && is_d1_outlier(error, truth) ? 1U : 0U;
    }
    double percent(std::size_t count) const { return percent_of(count, judged); }
};

}  // namespace

Accuracy measure(const images::FloatMap& disparity, const images::FloatMap& truth,
                 const std::vector<std::uint8_t>& non_occluded, const std::vector<std::uint8_t>& thin) {
    const auto fits = [&truth](const std::vector<std::uint8_t>& mask) {
        return mask.empty() || mask.size() == truth.values.size();
    };
    if (disparity.width != truth.width || disparity.height != truth.height || !fits(non_occluded) || !fits(thin)) {
        throw std::invalid_argument(
            "disparity, ground truth and mask differ in size: " + std::to_string(disparity.width) + " x " +
            std::to_string(disparity.height) + " px against " + std::to_string(truth.width) + " x " +
            std::to_string(truth.height));
    }
    Tally all, visible, on_thin;
    for (std::size_t i = 0; i < truth.values.size(); ++i) {
        if (!std::isfinite(truth.values[i])) {
            continue;
        }
        all.add(disparity.values[i], truth.values[i]);
        if (!non_occluded.empty() && non_occluded[i] != 0) {
            visible.add(disparity.values[i], truth.values[i]);
        }
        if (!thin.empty() && thin[i] != 0) {
            on_thin.add(disparity.values[i], truth.values[i]);
        }
    }
    return {
        visible.percent(visible.bad1), all.percent(all.bad1),           visible.percent(visible.bad2),
        all.percent(all.bad2),         all.percent(all.valid),          visible.percent(visible.d1),
        all.percent(all.d1),           percent_of(all.near, all.valid), on_thin.percent(on_thin.judged - on_thin.bad1)};
}

}  // namespace disparityd::eval
