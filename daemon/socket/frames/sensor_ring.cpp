// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/frames/sensor_ring.h"

#include <algorithm>

#include "daemon/sensor_message.h"

namespace disparityd::daemon {

void SensorRing::put(const std::vector<capture::SensorSample>& samples, Time newest) {
    samples_.insert(samples_.end(), samples.begin(), samples.end());
    if (samples_.size() > capacity) {
        samples_.erase(samples_.begin(), samples_.end() - capacity);
    }
    end_ += samples.size();
    newest_ = newest;
}

std::uint64_t SensorRing::fill(std::uint64_t from, v1::Sensors& message) const {
    const std::uint64_t begin = end_ - samples_.size();
    for (std::uint64_t i = std::max(from, begin); i < end_; ++i) {
        fill_message(samples_[i - begin], *message.add_samples());
    }
    message.set_skipped(from < begin ? begin - from : 0);
    message.set_age_ns((std::chrono::steady_clock::now() - newest_).count());
    return end_;
}

}  // namespace disparityd::daemon
