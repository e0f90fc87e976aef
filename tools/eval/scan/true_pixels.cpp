// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/scan/true_pixels.h"

#include <algorithm>
#include <cmath>

namespace disparityd::eval {
namespace {

constexpr std::uint8_t sure = 255;

/// Fills the gaps of one line of `count` values that are `step` apart.
void fill_gaps(float* values, int count, std::ptrdiff_t step, int most_gap) {
    int known = -1;
    for (int i = 0; i < count; ++i) {
        const float value = values[i * step];
        if (!std::isfinite(value)) {
            continue;
        }
        if (known >= 0 && i - known - 1 <= most_gap) {
            const float farther = std::min(value, values[known * step]);
            for (int j = known + 1; j < i; ++j) {
                values[j * step] = farther;
            }
        }
        known = i;
    }
}

}  // namespace

TruePixels::TruePixels(const images::FloatMap& truth, int most_gap)
    : width_(truth.width), height_(truth.height), disparity_(truth.values.size()), confidence_(truth.values.size()) {
    std::vector<float> values = truth.values;
    for (int y = 0; y < height_; ++y) {
        fill_gaps(&values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_)], width_, 1, most_gap);
    }
    for (int x = 0; x < width_; ++x) {
        fill_gaps(&values[static_cast<std::size_t>(x)], height_, width_, most_gap);
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
        const bool known = std::isfinite(values[i]);
        constexpr float largest = 2047;
        disparity_[i] =
            static_cast<std::int16_t>(known ? std::lround(16 * std::clamp(values[i], -largest, largest)) : 0);
        confidence_[i] = known ? sure : 0;
    }
}

scan::Pixels TruePixels::pixels() const {
    return {{disparity_.data(), width_, height_, width_}, {confidence_.data(), width_, height_, width_}};
}

}  // namespace disparityd::eval
