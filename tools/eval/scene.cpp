// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/scene.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "base/message_text.h"
#include "capture/images/image_files.h"
#include "tools/command_line/program.h"
#include "tools/datasets/announced_range.h"

namespace disparityd::eval {
namespace {

/// The ndisp of the calib.txt that Middlebury and ETH3D put beside their pictures; 0 where there is none.
int announced_disparities(const std::string& picture) {
    const auto announced =
        datasets::range_of_calibration((std::filesystem::path(picture).parent_path() / "calib.txt").string());
    return announced ? static_cast<int>(announced->largest) + 1 : 0;
}

}  // namespace

std::vector<datasets::DatasetScene> find_scenes(const std::vector<std::string>& folders) {
    std::vector<datasets::DatasetScene> all;
    for (const std::string& folder : folders) {
        datasets::FoundScenes found = datasets::look_for_scenes(folder);
        for (const std::string& line : found.incomplete) {
            tools::print_note(line);
        }
        if (found.scenes.empty()) {
            throw std::invalid_argument(folder +
                                        ": found no scene with ground truth, allowed: folders as Middlebury, ETH3D, "
                                        "KITTI, Sintel, SceneFlow and DrivingStereo have them (left and right picture "
                                        "with disp_left or disp0; image_2, image_3, disp_occ_0; ...)");
        }
        std::move(found.scenes.begin(), found.scenes.end(), std::back_inserter(all));
    }
    return all;
}

Scene read_scene(const datasets::DatasetScene& files, double scale) {
    Scene scene{files.name, capture::read_image(files.left), capture::read_image(files.right), {}, {}, {}, 0};
    if (scene.left.type() != scene.right.type()) {
        cv::cvtColor(scene.left.channels() == 3 ? scene.left : scene.right,
                     scene.left.channels() == 3 ? scene.left : scene.right, cv::COLOR_BGR2GRAY);
    }
    datasets::GroundTruth truth = datasets::read_ground_truth(files, scale);
    if (scene.left.size() != scene.right.size() || scene.left.cols != truth.width || scene.left.rows != truth.height) {
        throw std::invalid_argument(files.left + ": found left " + base::size_text(scene.left.cols, scene.left.rows) +
                                    ", right " + base::size_text(scene.right.cols, scene.right.rows) +
                                    ", ground truth " + base::size_text(truth.width, truth.height) +
                                    ", allowed: three of one size");
    }
    if (truth.knows_occlusion) {
        std::transform(
            truth.classes.begin(), truth.classes.end(), std::back_inserter(scene.non_occluded),
            [](datasets::TruthClass known) -> std::uint8_t { return known == datasets::TruthClass::visible; });
    }
    scene.foreground = std::move(truth.foreground);
    scene.truth = {truth.width, truth.height, std::move(truth.disparity)};
    scene.disparities = covering_disparities(scene.truth, announced_disparities(files.left));
    return scene;
}

int covering_disparities(const images::FloatMap& truth, int ndisp) {
    float largest = 0;
    for (const float disparity : truth.values) {
        largest = std::isfinite(disparity) ? std::max(largest, disparity) : largest;
    }
    const double needed = std::max(std::ceil(static_cast<double>(largest)) + 1, static_cast<double>(ndisp));
    return static_cast<int>(std::clamp(std::ceil(needed / 16) * 16, 16.0, 256.0));
}

}  // namespace disparityd::eval
