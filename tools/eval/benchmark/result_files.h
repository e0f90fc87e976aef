// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tools/images/disparity_map.h"

namespace disparityd::eval {

/// Where one matcher's files of all scenes lie: a folder, or a pattern with {scene}, {folder} and {frame}. The name of
/// a scene, such as training/000000_10 or alley_1/frame_0001, is {scene}; what stands before its last slash is
/// {folder}, the rest {frame}.
struct ResultFiles {
    std::string matcher;  ///< its name in tables
    std::string where;
};

/// Reads NAME=WHERE, or WHERE alone, whose last part is the name then. Throws std::invalid_argument for an empty part
/// and for a folder that is not there.
ResultFiles parse_result_files(const std::string& option, const std::string& text);

/// The file of a scene. In a folder it is one of these, with .pfm or, where there is no such file, .png:
/// SCENE, FRAME, SCENE with "_" for each slash; disp_0/FRAME (KITTI 2015's submissions); SCENE/disp0,
/// SCENE/disp0 with any name behind it but GT, which is the ground truth (Middlebury's submissions), and both for
/// FRAME.
/// Throws std::invalid_argument with one line where there is none, and where several could be meant.
std::string find_result(const ResultFiles& files, const std::string& scene);

/// Reads disparities in px: PFM as it is, where values that are not finite are holes, or KITTI's PNG of 16 bits (value
/// / 256, 0 = a hole). Throws std::invalid_argument with one line (file, what was found, what is allowed), also for
/// another size than `width` x `height`.
images::FloatMap read_result(const std::string& path, int width, int height);

/// Reads confidences, where larger is surer: PFM, or a grey image of 8 or 16 bits. Errors as read_result(), and for a
/// value that is not finite.
std::vector<float> read_confidence(const std::string& path, int width, int height);

}  // namespace disparityd::eval
