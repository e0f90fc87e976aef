// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "capture/calibration.h"
#include "capture/camera_trouble.h"
#include "capture/camera_uri.h"
#include "capture/frame_source.h"
#include "capture/video_system.h"

namespace disparityd::capture {

/// Who a camera is, and which calibration belongs to it. One thread.
class CameraIdentity {
public:
    /// Borrows all three.
    CameraIdentity(VideoSystem& system, const CameraRequest& request, const SourceOptions& options)
        : system_(system), request_(request), options_(options) {}

    /// Puts in the serial number that the camera itself gives; the USB descriptors of ZED cameras may all say the same.
    /// Trouble only when the number is asked for and cannot be had.
    std::optional<CameraTrouble> identify(UsbCamera& camera);

    /// What the camera that will probably be used brings; nothing when there is none or its file is damaged, which
    /// check_calibration() says.
    std::optional<StereoCalibration> likely_calibration();

    /// Whether this camera may run with the calibration in use.
    std::optional<CameraTrouble> check_calibration(const UsbCamera& camera,
                                                   const std::optional<StereoCalibration>& in_use) const;

private:
    VideoSystem& system_;
    const CameraRequest& request_;
    const SourceOptions& options_;
    std::optional<UsbCamera> asked_;  ///< with the serial number that it gave
};

}  // namespace disparityd::capture
