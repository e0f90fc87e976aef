// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>

#include "bridges/ros_messages/raw_messages.h"
#include "clients/cpp/disparity_client.hpp"

namespace disparityd::tools {

/// What a daemon's status says of the cameras. It holds for frames with this calibration.
struct ToldCameras {
    std::uint64_t calibration_id = 0;
    double baseline_m = 0;                                ///< 0: not known
    std::optional<disparity::InertialPose> sensor = {};   ///< the inertial sensor's
    std::shared_ptr<const ros::RawCalibration> raw = {};  ///< of the lenses; null: nothing is known
};

/// Keeps what was told of the last calibrations, since a frame may still wait while a later one holds. Any thread.
class CamerasByCalibration {
public:
    static constexpr std::size_t most = 16;  ///< the oldest makes room

    void take(ToldCameras told);

    /// Returns what was told last for this calibration; null: nothing was.
    std::shared_ptr<const ToldCameras> of(std::uint64_t calibration_id) const;

private:
    mutable std::mutex mutex_;
    std::deque<std::shared_ptr<const ToldCameras>> told_;  ///< the newest first
};

}  // namespace disparityd::tools
