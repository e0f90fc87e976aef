// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/recording/told_cameras.h"

#include <algorithm>
#include <utility>

namespace disparityd::tools {

void CamerasByCalibration::take(ToldCameras told) {
    const std::lock_guard lock(mutex_);
    // Told again, it must not push another one out.
    std::erase_if(told_, [&told](const auto& known) { return known->calibration_id == told.calibration_id; });
    told_.push_front(std::make_shared<const ToldCameras>(std::move(told)));
    if (told_.size() > most) {
        told_.pop_back();
    }
}

std::shared_ptr<const ToldCameras> CamerasByCalibration::of(std::uint64_t calibration_id) const {
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(told_.begin(), told_.end(), [calibration_id](const auto& told) {
        return told->calibration_id == calibration_id;
    });
    return found == told_.end() ? nullptr : *found;
}

}  // namespace disparityd::tools
