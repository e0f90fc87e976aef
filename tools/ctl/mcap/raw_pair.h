// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "bridges/ros_messages/camera_info_message.h"
#include "calibration/calibration_correction.h"
#include "capture/frame_source.h"
#include "tools/ctl/mcap/ros_mcap.h"

namespace disparityd::tools {

/// Whether distances are known by it: one of images that are rectified already may lack a focal length or a baseline.
bool gives_distances(const calibration::StereoCalibration& calibration);

/// Returns the calibration as the recorded correction of a frame changes it. Throws std::runtime_error with one line
/// for a correction that no camera can need.
calibration::StereoCalibration calibration_of(const capture::RawFrame& frame,
                                              const calibration::StereoCalibration& calibration);

/// Makes messages of frames as they were captured: an image of each eye and, where a calibration is known, its
/// CameraInfo with lens, rotation and projection. Images of a source that is rectified already have the topics of
/// rectified ones. One thread uses an object at a time.
class RawPair {
public:
    /// `camera` is the name of the camera: topics are below /CAMERA.
    RawPair(const capture::SourceInfo& source, const std::string& camera);

    /// Returns the messages of a frame, which is corrected as it says. Throws as calibration_of().
    std::vector<RosMessageBytes> messages_of(const capture::RawFrame& frame);

    /// Whether the source's images are rectified already.
    bool is_rectified() const { return rectified_; }

private:
    using Infos = std::array<ros::CameraInfoFields, 2>;

    void describe(const calibration::StereoCalibration& used);

    std::optional<calibration::StereoCalibration> calibration_;  ///< where it gives distances
    bool rectified_ = false;
    std::string frame_;  ///< of reference: both eyes have that of the left one, as programs ask for that take pairs
    std::array<std::string, 2> images_, infos_;  ///< topics: left, right
    calibration::CalibrationCorrection correction_;
    std::optional<Infos> fields_;  ///< of correction_; none where no distances are known
};

}  // namespace disparityd::tools
