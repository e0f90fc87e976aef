// SPDX-License-Identifier: Apache-2.0
#include "capture/sensors/sensor_clock.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace disparityd::capture {

namespace {

constexpr double second = 1e9;

/// A sample that arrives so long before its time, or after so many late seconds, belongs to another clock.
constexpr double most_early = second;
constexpr double most_late = second / 10;
constexpr int most_late_seconds = 3;
/// A gap of the camera's clock; samples come some hundred times a second.
constexpr double most_gap = 60 * second;

/// Quartz clocks differ by far less. A drift measured over a few seconds would be worse than none.
constexpr double most_drift = 500e-6;
constexpr std::size_t seconds_for_drift = 8;

}  // namespace

void SensorClock::begin(std::int64_t camera_ns, std::int64_t arrived_ns) {
    begun_ = true;
    samples_ = 0;
    late_seconds_ = 0;
    camera_origin_ = camera_ns;
    host_origin_ = arrived_ns;
    last_camera_ = -1;
    offset_ = 0;
    drift_ = 0;
    second_start_ = 0;
    quickest_ = {};
    seconds_seen_ = 0;
}

bool SensorClock::jumped(std::int64_t camera_ns, std::int64_t arrived_ns) const {
    const double camera = static_cast<double>(camera_ns - camera_origin_);
    const double late = static_cast<double>(arrived_ns - host_origin_) - camera - line(camera);
    return camera <= last_camera_ || camera > last_camera_ + most_gap || late < -most_early ||
           late_seconds_ >= most_late_seconds;
}

std::optional<std::int64_t> SensorClock::map(std::int64_t camera_ns, std::int64_t arrived_ns) {
    if (!begun_) {
        begin(camera_ns, arrived_ns);
    } else if (jumped(camera_ns, arrived_ns)) {
        ++jumps_;
        begin(camera_ns, arrived_ns);
    }
    const double camera = static_cast<double>(camera_ns - camera_origin_);
    const double apart = static_cast<double>(arrived_ns - host_origin_) - camera;
    last_camera_ = camera;
    offset_ = std::min(offset_, apart - drift_ * camera);
    if (camera >= second_start_ + second) {
        close_second();
        second_start_ = camera;
        quickest_ = {camera, apart};
    } else if (apart - drift_ * camera < quickest_.apart - drift_ * quickest_.camera) {
        quickest_ = {camera, apart};
    }
    if (samples_ < settling_samples) {
        ++samples_;
        return std::nullopt;
    }
    const auto mapped = host_origin_ + static_cast<std::int64_t>(std::llround(camera + line(camera)));
    last_mapped_ = std::max(last_mapped_ + 1, std::min(mapped, arrived_ns));
    return last_mapped_;
}

void SensorClock::close_second() {
    late_seconds_ = quickest_.apart - line(quickest_.camera) > most_late ? late_seconds_ + 1 : 0;
    seconds_[seconds_seen_ % most_seconds] = quickest_;
    ++seconds_seen_;
    fit();
}

/// Takes the median of the slopes between all pairs of seconds, and the highest line of that slope with no second below
/// it.
void SensorClock::fit() {
    const std::size_t known = std::min(seconds_seen_, most_seconds);
    if (known >= seconds_for_drift) {
        std::vector<double> slopes;
        slopes.reserve(known * (known - 1) / 2);
        for (std::size_t i = 0; i < known; ++i) {
            for (std::size_t k = 0; k < i; ++k) {
                slopes.push_back((seconds_[i].apart - seconds_[k].apart) / (seconds_[i].camera - seconds_[k].camera));
            }
        }
        const auto middle = slopes.begin() + static_cast<std::ptrdiff_t>(slopes.size() / 2);
        std::nth_element(slopes.begin(), middle, slopes.end());
        drift_ = std::clamp(*middle, -most_drift, most_drift);
    }
    offset_ = seconds_[0].apart - drift_ * seconds_[0].camera;
    for (std::size_t i = 1; i < known; ++i) {
        offset_ = std::min(offset_, seconds_[i].apart - drift_ * seconds_[i].camera);
    }
}

}  // namespace disparityd::capture
