// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "calibration/board/board.h"

namespace disparityd::calibration {

/// Coverage is told for 3 x 3 parts of an image, row by row.
constexpr int coverage_side = 3;
constexpr std::size_t coverage_parts = coverage_side * coverage_side;

/// Which of an eye's image a set of views has shown.
struct EyeCoverage {
    std::array<bool, coverage_parts> parts{};  ///< those that hold a corner
    /// Of the image, that the boards have covered: within the outline of the corners of any view; 0 .. 1, exact to
    /// about 0.01. Not all of it can be: both eyes must see the board, and an edge lies beside its outermost corners.
    double ratio = 0;
};

struct Coverage {
    EyeCoverage left;
    EyeCoverage right;
};

/// Measures the coverage of images of width x height px.
Coverage coverage_of(const std::vector<BoardView>& views, int width, int height);

/// Returns the parts of an eye's image without a corner, as lines for the user: those of both eyes first, as one view
/// may mend both.
std::vector<std::string> missing_parts(const Coverage& coverage);

/// Returns what a set of views lacks but for the coverage, as lines for the user: a near board, enough tilted ones.
/// `width`: of the images, px.
std::vector<std::string> missing_poses(const std::vector<BoardView>& views, const Board& board, int width);

/// Returns all that a set of views lacks: missing_parts(), then missing_poses(). Nothing when the views suffice.
std::vector<std::string> missing_views(const std::vector<BoardView>& views, const Board& board, int width, int height);

}  // namespace disparityd::calibration
