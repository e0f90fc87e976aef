// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "kernels/matcher.h"
#include "obstacles/scan_geometry.h"
#include "obstacles/scan_options.h"
#include "tools/datasets/dataset.h"
#include "tools/eval/scene.h"

namespace disparityd::eval {

/// A scene whose distances are known.
struct SceneToScan {
    SceneToJudge scene;
    std::function<scan::Camera(int width, int height)> camera;  ///< throws std::invalid_argument where it is not known
};

/// Returns the camera of a data set's scene, from the calibration beside it: Middlebury's calib.txt, or KITTI's. Throws
/// std::invalid_argument with one line where there is none.
scan::Camera camera_of(const datasets::DatasetScene& files, int width, int height);

/// Returns the camera of a rendered scene.
scan::Camera camera_of_rendered(int width, int height);

/// The scenes with ground truth in folders and below, and rendered ones; `scale` as read_scene() takes it. Throws
/// std::invalid_argument for a folder without one.
std::vector<SceneToScan> scenes_to_scan(const std::vector<std::string>& data, double scale);

/// What `disparity-eval --scan DATA` runs.
struct DataEvaluation {
    std::vector<SceneToScan> scenes;
    std::function<MatchOptions(int disparities)> match;
    ScanOptions scan;
    const Backend* backend = nullptr;
};

/// Scans what matching finds and what is true, and prints a table: one row per scene, then all. Shows progress; a
/// Ctrl-C ends it. Throws std::invalid_argument as the scenes do.
void report_data_scans(const DataEvaluation& evaluation, Parallel& workers, bool markdown);

}  // namespace disparityd::eval
