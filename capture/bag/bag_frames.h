// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>

#include "calibration/inertial_calibration.h"
#include "formats/ros_message.h"

namespace disparityd::capture {

/// How the frames of axes of a robot lie to each other, by its messages on /tf_static. One thread uses an object.
class BagFrames {
public:
    /// Takes a tf2_msgs/msg/TFMessage: of it the first 64 transforms. What is no rotation, and more than 1000 frames,
    /// are passed over.
    void take(const formats::RosMessage& message);

    /// Returns what takes points of one frame to another; nothing where the two have no frame above them in common.
    std::optional<calibration::Pose> between(const std::string& from, const std::string& to) const;

private:
    struct Parent {
        std::string name;
        calibration::Pose pose;  ///< takes points of the frame to the parent
    };

    /// A frame that has no parent, and what leads there.
    Parent top_of(const std::string& frame) const;

    std::map<std::string, Parent> parents_;
};

}  // namespace disparityd::capture
