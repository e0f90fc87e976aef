// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "tools/datasets/dataset.h"

namespace disparityd::bench {

/// What is to be matched: a scene of the paper, or the rendered scene in some size.
struct PairRequest {
    std::string scene;  ///< the paper's name in lower case, or "rendered"
    int width = 0;      ///< of the rendered scene
    int height = 0;
    int disparities = 0;

    bool rendered() const { return width > 0; }
};

/// The words of --pair: "paper" (its four scenes), one of their names, "rendered" (six sizes),
/// WIDTHxHEIGHTxDISPARITIES. Throws std::invalid_argument for any other word.
std::vector<PairRequest> parse_pairs(const std::vector<std::string>& words);

/// A rectified grey pair in memory.
struct StereoPair {
    std::string scene;
    cv::Mat left;
    cv::Mat right;
    int disparities = 0;

    double candidates() const { return static_cast<double>(left.total()) * disparities; }
};

/// The scenes of evaluation data in `folder`, or in what DISPARITYD_DATA names where it is empty; none without either.
/// Throws std::invalid_argument where that is no folder.
std::vector<datasets::DatasetScene> find_scenes(std::string folder);

/// Whether load() has what it needs; else a note on stderr says that the pair is skipped, and why.
bool available(const PairRequest& request, const std::vector<datasets::DatasetScene>& found);

/// Renders the scene, or reads the files of the paper's scene among `found`. Throws std::invalid_argument with one line
/// when that does not work; `found` has the scene.
StereoPair load(const PairRequest& request, const std::vector<datasets::DatasetScene>& found);

/// The rendered scene, rectified, seen by a camera with eyes of this size.
StereoPair render(int width, int height, int disparities);

}  // namespace disparityd::bench
