// SPDX-License-Identifier: Apache-2.0
#include "pipeline/distance_limits.h"

#include <algorithm>
#include <cmath>

#include "kernels/parallel_rows.h"

namespace disparityd::pipeline {
namespace {

/// More than any disparity with its offset.
constexpr int beyond_all = 1 << 20;

/// The depth of step 13 in mm, before it is cut to 16 bits.
std::int64_t depth_mm(const DepthScale& scale, int n) {
    return std::max<std::int64_t>((scale.k + n / 2) / n, 1);
}

/// Returns the least disparity that has at most this depth.
int least_disparity(const DepthScale& scale, std::int64_t most_mm) {
    int least = 1;
    for (int end = beyond_all; least < end;) {
        const int middle = least + (end - least) / 2;
        if (depth_mm(scale, middle) <= most_mm) {
            end = middle;
        } else {
            least = middle + 1;
        }
    }
    return least;
}

std::int64_t millimetres(double metres) {
    return std::llround(1000 * metres);
}

template <typename T>
void put(Plane<T> plane, int x, int y, T value) {
    if (plane) {
        plane.at(x, y) = value;
    }
}

}  // namespace

DistanceLimitStage::DistanceLimitStage(const DistanceLimits& limits, DisparityRange range,
                                       const DistanceLimitNames& names)
    : limits_(limits), range_(range), names_(names) {}

void DistanceLimitStage::set(const DepthScale& scale) {
    scale_ = scale;
    least_ = limits_.max_m > 0 ? least_disparity(scale, millimetres(limits_.max_m)) : -beyond_all;
    most_ = limits_.min_m > 0 ? least_disparity(scale, millimetres(limits_.min_m) - 1) - 1 : beyond_all;
    effect_.store(effect_of(scale), std::memory_order_relaxed);
}

DistanceLimitStage::Effect DistanceLimitStage::effect_of(const DepthScale& scale) const {
    const int farthest = 16 * range_.first + scale.offset16;
    const int nearest = 16 * (range_.first + range_.count - 1) + scale.offset16;
    if (nearest < least_ || farthest > most_) {
        return Effect::nothing_left;
    }
    const bool min_in_vain = limits_.min_m > 0 && nearest <= most_;
    const bool max_in_vain = limits_.max_m > 0 && farthest >= least_;
    if (min_in_vain && max_in_vain) {
        return Effect::no_effect;
    }
    return min_in_vain ? Effect::min_too_near : max_in_vain ? Effect::max_too_far : Effect::as_wanted;
}

void DistanceLimitStage::run(const StageFrame& frame, Parallel& workers) {
    const FrameView& view = frame.view;
    if (view.depth_scale.k <= 0) {
        effect_.store(Effect::no_distances, std::memory_order_relaxed);
        return;
    }
    if (view.depth_scale.k != scale_.k || view.depth_scale.offset16 != scale_.offset16) {
        set(view.depth_scale);
    }
    const std::int16_t invalid = invalid_disparity(range_);
    parallel_rows(view.disparity.height, workers, [&](Rows rows) {
        for (int y = rows.first; y < rows.last; ++y) {
            for (int x = 0; x < view.disparity.width; ++x) {
                const int n = view.disparity.at(x, y) + scale_.offset16;
                if (n >= least_ && n <= most_) {
                    continue;
                }
                view.disparity.at(x, y) = invalid;
                view.confidence.at(x, y) = 0;
                put(view.depth, x, y, std::uint16_t{0});
                put(view.depth_error, x, y, std::uint16_t{0});
            }
        }
    });
}

std::string DistanceLimitStage::notice() const {
    const std::string min(names_.min);
    const std::string max(names_.max);
    switch (effect_.load(std::memory_order_relaxed)) {
        case Effect::as_wanted: return {};
        case Effect::no_distances:
            return min + " and " + max + " have no effect: no calibration, so no distance is known";
        case Effect::min_too_near:
            return min + " has no effect: the range of disparities measures nothing that is nearer";
        case Effect::max_too_far:
            return max + " has no effect: the range of disparities measures nothing that is farther";
        case Effect::no_effect:
            return min + " and " + max + " have no effect: the range of disparities measures nothing beyond them";
        case Effect::nothing_left:
            return min + " and " + max + " leave nothing: the range of disparities measures no distance between them";
    }
    return {};
}

}  // namespace disparityd::pipeline
