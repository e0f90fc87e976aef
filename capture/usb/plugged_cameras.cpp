// SPDX-License-Identifier: Apache-2.0
#include "capture/usb/plugged_cameras.h"

#include <algorithm>
#include <utility>

namespace disparityd::capture {

bool PluggedCameras::note(const std::vector<UsbCamera>& cameras, Clock::time_point now) {
    std::vector<Plugged> plugged;
    bool came = false;
    for (const UsbCamera& camera : cameras) {
        const Clock::time_point since = this->since(camera);
        const bool known = since != Clock::time_point::min();
        came = came || !known;
        plugged.push_back({camera, known ? since : now});
    }
    plugged_ = std::move(plugged);
    return came;
}

PluggedCameras::Clock::time_point PluggedCameras::since(const UsbCamera& camera) const {
    const auto known = std::find_if(plugged_.begin(), plugged_.end(),
                                    [&](const Plugged& p) { return same_plugging(p.camera, camera); });
    return known == plugged_.end() ? Clock::time_point::min() : known->since;
}

}  // namespace disparityd::capture
