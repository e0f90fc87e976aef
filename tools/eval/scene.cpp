// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/scene.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "capture/message_text.h"
#include "tools/images/image_file.h"

namespace disparityd::eval {
namespace {

cv::Mat read_8_bit(const std::string& path) {
    cv::Mat picture = images::read_image(path);
    if (picture.depth() != CV_8U) {
        throw std::invalid_argument(path + ": found " + std::to_string(picture.elemSize1() * 8) +
                                    " bits per channel, allowed: 8");
    }
    if (picture.channels() == 4) {
        cv::cvtColor(picture, picture, cv::COLOR_BGRA2BGR);
    }
    return picture;
}

/// "ndisp=N" of the calib.txt that Middlebury puts beside its pictures; 0 where there is none.
int announced_disparities(const std::string& picture) {
    std::ifstream file(std::filesystem::path(picture).parent_path() / "calib.txt");
    const std::string key = "ndisp=";
    for (std::string line; std::getline(file, line);) {
        if (line.compare(0, key.size(), key) == 0) {
            return std::atoi(line.c_str() + key.size());
        }
    }
    return 0;
}

}  // namespace

std::vector<capture::DatasetScene> find_scenes(const std::vector<std::string>& folders) {
    std::vector<capture::DatasetScene> all;
    for (const std::string& folder : folders) {
        std::vector<capture::DatasetScene> found = capture::find_scenes(folder);
        if (found.empty()) {
            throw std::invalid_argument(folder +
                                        ": found no scene with ground truth, allowed: Middlebury folders (left "
                                        "and right picture, disp_left or disp0) or KITTI folders (image_2, "
                                        "image_3, disp_occ_0)");
        }
        std::move(found.begin(), found.end(), std::back_inserter(all));
    }
    return all;
}

Scene read_scene(const capture::DatasetScene& files, double scale) {
    Scene scene{files.name, read_8_bit(files.left), read_8_bit(files.right), {}, {}, 0};
    if (scene.left.type() != scene.right.type()) {
        cv::cvtColor(scene.left.channels() == 3 ? scene.left : scene.right,
                     scene.left.channels() == 3 ? scene.left : scene.right, cv::COLOR_BGR2GRAY);
    }
    capture::GroundTruth truth = capture::read_ground_truth(files, scale);
    if (scene.left.size() != scene.right.size() || scene.left.cols != truth.width || scene.left.rows != truth.height) {
        throw std::invalid_argument(files.left + ": found left " +
                                    capture::size_text(scene.left.cols, scene.left.rows) + ", right " +
                                    capture::size_text(scene.right.cols, scene.right.rows) + ", ground truth " +
                                    capture::size_text(truth.width, truth.height) + ", allowed: three of one size");
    }
    if (truth.knows_occlusion) {
        std::transform(truth.classes.begin(), truth.classes.end(), std::back_inserter(scene.non_occluded),
                       [](capture::TruthClass known) -> std::uint8_t { return known == capture::TruthClass::visible; });
    }
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
