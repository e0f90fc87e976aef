// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "capture/bag/bag_messages.h"
#include "capture/bag/bag_uri.h"

namespace disparityd::capture {

/// The topics that a source reads.
struct ChosenTopics {
    std::string left;       ///< images of the left eye, or of both side by side where `right` is empty
    std::string right;      ///< images of the right eye
    std::string left_info;  ///< CameraInfo; empty: there is none
    std::string right_info;
    std::string imu;         ///< empty: there is none
    std::string transforms;  ///< /tf_static, where the bag has an inertial sensor, too; empty: there is none
    bool rectified = false;
    std::vector<std::string> notices;  ///< one line each: what was found, and what was left out
};

/// Chooses by names: those that the user gave, else the one pair whose names differ as those of two eyes do (of several
/// the one that alone has a CameraInfo for both eyes), else the one topic with images, which then has both eyes. Throws
/// std::invalid_argument with one line that lists what there is.
ChosenTopics choose_topics(const BagUri& uri, const std::vector<BagTopic>& topics);

}  // namespace disparityd::capture
