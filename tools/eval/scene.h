// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "tools/datasets/dataset.h"
#include "tools/images/disparity_map.h"

namespace disparityd::eval {

/// A rectified pair with ground truth, in memory.
struct Scene {
    std::string name;
    cv::Mat left;  ///< grey or BGR, 8 bit
    cv::Mat right;
    images::FloatMap truth;                  ///< disparity of the left image in px, +infinity where unknown
    std::vector<std::uint8_t> non_occluded;  ///< one per pixel, 1 = both cameras see it; empty = not known
    std::vector<std::uint8_t> thin;          ///< one per pixel, 1 = a pole or a wire; empty = not known
    int disparities = 0;                     ///< candidates that cover the truth, a multiple of 16 up to 256
    std::vector<std::uint8_t> foreground{};  ///< one per pixel, 1 = on a car of KITTI 2015; empty = not known
};

/// The scenes with ground truth in each folder and below. A note on stderr tells of each pair that cannot be judged
/// (datasets::FoundScenes). Throws std::invalid_argument for a folder without a scene.
std::vector<datasets::DatasetScene> find_scenes(const std::vector<std::string>& folders);

/// Reads pictures and truth; `scale` other than 0 is the stored value per pixel of disparity. Throws
/// std::invalid_argument with one line when the scene does not hold together.
Scene read_scene(const datasets::DatasetScene& files, double scale);

/// The smallest multiple of 16, 16 .. 256, of candidates 0, 1, ... that reach every known disparity and the bound
/// `ndisp` (0 = none is given).
int covering_disparities(const images::FloatMap& truth, int ndisp);

/// A scene before it is in memory.
struct SceneToJudge {
    std::string name;
    int disparities = 0;  ///< number of candidates; 0 = as the scene needs
    std::function<Scene()> read;
    std::vector<std::string> truths{};  ///< files of ground truth, some of them empty; none where it is rendered
};

/// Returns a scene of which there are files; `scale` as read_scene() takes it.
inline SceneToJudge scene_of_files(const datasets::DatasetScene& files, int disparities, double scale) {
    return {files.name,
            disparities,
            [files, scale] { return read_scene(files, scale); },
            {files.truth, files.visible_truth, files.right_truth}};
}

}  // namespace disparityd::eval
