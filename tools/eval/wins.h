// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tools/eval/report.h"

namespace disparityd::eval {

/// The name under which a method's result stands when every pixel is judged.
std::string fair_name(const std::string& method);

/// Returns whether every pixel is judged in this row.
bool is_fair(const Row& row);

bool is_opencv(const Row& row);

/// Returns the least bad-1.0 (non-occluded) of the fair rows of OpenCV; infinity where there is none.
double best_of_opencv(const std::vector<Row>& scene);

/// One scene of one of our results beside OpenCV, both with every pixel judged: bad-1.0, non-occluded, in percent.
struct Comparison {
    std::string scene;
    double ours = 0;
    double opencv = 0;  ///< the best of OpenCV's matchers on this scene

    /// A scene is won when ours is at most the best of OpenCV.
    bool won() const { return ours <= opencv; }
};

struct Wins {
    std::string method;  ///< without what fair_name() adds
    std::string backend;
    std::vector<Comparison> scenes;
};

/// Compares each of our fair rows with OpenCV's fair rows of the same scene; a scene without either, or without a mask
/// of non-occluded pixels, is left out. Rows of one scene stand one after the other; other rows than fair ones do not
/// count. One entry for each method and back end.
std::vector<Wins> wins(const std::vector<Row>& rows);

}  // namespace disparityd::eval
