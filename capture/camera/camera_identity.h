// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "calibration/calibration.h"
#include "capture/camera/camera_problem.h"
#include "capture/camera/camera_uri.h"
#include "capture/camera/video_system.h"
#include "capture/frame_source.h"

namespace disparityd::capture {

/// Returns what the calibration of two cameras is found by, "LEFT-RIGHT"; nothing where their serial numbers do not
/// tell them apart.
std::string pair_serial(const std::string& left, const std::string& right);

/// Returns what is known of a source before a camera is there: without calibration and serial number.
SourceInfo info_of_camera(const CameraRequest& request, const SourceOptions& options);

/// Finds out which camera a device is, and which calibration belongs to it. One thread.
class CameraIdentity {
public:
    /// Borrows all three.
    CameraIdentity(VideoSystem& system, const CameraRequest& request, const SourceOptions& options)
        : system_(system), request_(request), options_(options) {}

    /// Puts in the serial number that the camera itself gives; the USB descriptors of ZED cameras may all say the same.
    /// Returns a problem when the number cannot be had now: without it a camera would pass for another one.
    std::optional<CameraProblem> identify(UsbCamera& camera);

    /// Puts in calibration and serial number of the camera that will probably be used: that of the URI, the one at this
    /// USB port (may be empty), the first that is there. No calibration when there is none or its file is damaged,
    /// which check_calibration() says, and no number without calibration.
    void expect_likely(SourceInfo& info, const std::string& port);

    /// The same of the camera with this serial number.
    void expect(SourceInfo& info, const std::string& serial) const;

    /// Checks that this camera has the calibration that the source was opened with and, where there is one, the same
    /// serial number.
    std::optional<CameraProblem> check_calibration(const UsbCamera& camera, const SourceInfo& in_use) const;

private:
    std::string likely_serial(const std::string& port);
    std::optional<calibration::StereoCalibration> calibration_of(const std::string& serial) const;

    VideoSystem& system_;
    const CameraRequest& request_;
    const SourceOptions& options_;
    std::optional<UsbCamera> asked_;  ///< with the serial number that it gave
};

}  // namespace disparityd::capture
