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
    /// Trouble when the number cannot be had now: without it a camera would pass for another one.
    std::optional<CameraTrouble> identify(UsbCamera& camera);

    /// Puts in calibration and serial number of the camera that will probably be used: that of the URI, the one at this
    /// USB port (may be empty), the first that is there. No calibration when there is none or its file is damaged,
    /// which check_calibration() says, and no number without calibration.
    void expect_likely(SourceInfo& info, const std::string& port);

    /// Whether this camera may run as what the source was opened for: the same calibration and, where there is one, the
    /// same serial number.
    std::optional<CameraTrouble> check_calibration(const UsbCamera& camera, const SourceInfo& in_use) const;

private:
    std::string likely_serial(const std::string& port);
    std::optional<StereoCalibration> calibration_of(const std::string& serial) const;

    VideoSystem& system_;
    const CameraRequest& request_;
    const SourceOptions& options_;
    std::optional<UsbCamera> asked_;  ///< with the serial number that it gave
};

}  // namespace disparityd::capture
