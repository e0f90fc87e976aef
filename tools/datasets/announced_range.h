// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace disparityd::datasets {

/// The largest disparity that the files of a dataset tell of.
struct AnnouncedRange {
    double largest = 0;  ///< px
    std::string origin;  ///< for people: "walk/calib.txt says ndisp=128"
};

/// Returns the bound ndisp of Middlebury's calib.txt, which ETH3D has, too, or vmax where that is larger; nothing where
/// the file is not there or says nothing. Throws std::invalid_argument with one line for an ndisp that is no bound.
std::optional<AnnouncedRange> range_of_calibration(const std::string& path);

/// Returns the range that the files of an image source (capture/images/image_sequence.h) tell of: the ndisp of a
/// calib.txt beside the first left image, or the largest disparity of the ground truth in the folder (Middlebury,
/// ETH3D, KITTI), whichever is larger. Nothing for other sources, and where no file tells. Reads all the ground truth.
std::optional<AnnouncedRange> range_of_images(const std::string& uri);

}  // namespace disparityd::datasets
