// SPDX-License-Identifier: Apache-2.0
#include "pipeline/gravity_filter.h"

#include <algorithm>
#include <cmath>

namespace disparityd::pipeline {
namespace {

constexpr double second_ns = 1e9;
constexpr std::int64_t stale_ns = 1'000'000'000;
/// A sample's weight falls to 1 / e in this time.
constexpr double time_constant_s = 0.5;
/// A sample stands for the time since the one before, but for no more than this.
constexpr double longest_s = 0.1;
/// So much weight is needed: at rest, a tenth of a second has it.
constexpr double least_weight_s = 0.1;
constexpr double gravity = 9.81;
/// Accelerations that are longer or shorter than gravity by this have no weight: the camera is shaken.
constexpr double shaken = 1;

}  // namespace

void GravityFilter::add(std::span<const capture::SensorSample> samples) {
    for (const capture::SensorSample& sample : samples) {
        if ((sample.flags & capture::sensor_flag_inertial) != 0) {
            add(sample);
        }
    }
}

void GravityFilter::add(const capture::SensorSample& sample) {
    const double x = sample.acceleration.x;
    const double y = sample.acceleration.y;
    const double z = sample.acceleration.z;
    const double length = std::sqrt(x * x + y * y + z * z);
    if (!std::isfinite(length)) {
        return;
    }
    // Times that fall are those of another run, such as of a recording that is played again.
    if (!begun_ || sample.monotonic_ns < newest_ns_) {
        begun_ = true;
        newest_ns_ = sample.monotonic_ns;
        sum_ = {};
        weight_ = 0;
        return;
    }
    const double passed_s = (static_cast<double>(sample.monotonic_ns) - static_cast<double>(newest_ns_)) / second_ns;
    newest_ns_ = sample.monotonic_ns;
    const double keep = time_constant_s / (time_constant_s + passed_s);
    const double calm = std::max(1 - std::abs(length - gravity) / shaken, 0.0);
    const double weight = calm * std::min(passed_s, longest_s);
    sum_ = {keep * sum_.x + weight * x, keep * sum_.y + weight * y, keep * sum_.z + weight * z};
    weight_ = keep * weight_ + weight;
    newest_calm_ns_ = calm > 0 ? sample.monotonic_ns : newest_calm_ns_;
}

std::optional<SensorDirection> GravityFilter::up_at(std::int64_t monotonic_ns) const {
    const double apart = std::abs(static_cast<double>(monotonic_ns) - static_cast<double>(newest_calm_ns_));
    const bool known = weight_ >= least_weight_s && apart <= static_cast<double>(stale_ns);
    return known && sum_ != SensorDirection{} ? std::optional(sum_) : std::nullopt;
}

}  // namespace disparityd::pipeline
