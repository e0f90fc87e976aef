// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "calibration/marker_codes.h"
#include "capture/calibration.h"
#include "kernels/image.h"

namespace disparityd::calibration {

/// The markers in the white squares of a ChArUco board.
struct BoardMarkers {
    const MarkerFamily* family = nullptr;  ///< see marker_family()
    double part = 0.7;                     ///< their side, of a square's
};

/// A chessboard by its inner corners: a board of 10 x 7 squares has 9 x 6 of them.
struct Board {
    int columns = 9;
    int rows = 6;
    double square_mm = 25;
    std::optional<BoardMarkers> markers{};  ///< none: a plain chessboard
};

/// The same corners, in the same order, in both eyes; px.
struct BoardView {
    std::vector<cv::Point2f> left;
    std::vector<cv::Point2f> right;
    std::vector<int> numbers;  ///< which of the board's corners, row by row, ascending
};

/// A board in both eyes, corners to a small part of a pixel. A chessboard must be seen whole; of one with markers,
/// eight common corners in two rows and columns suffice. None when an eye does not see so much.
std::optional<BoardView> find_board(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right,
                                    const Board& board);

/// How far the corners have moved from one view to another: the mean distance in the left eye of those that both have,
/// px; infinite when there are none.
double moved(const BoardView& before, const BoardView& after);

/// What a set of views does not show yet, for the person with the board in hand: parts of the left image without a
/// corner, no near board, too few tilted ones. Empty: enough.
std::vector<std::string> missing_views(const std::vector<BoardView>& views, const Board& board, int width, int height);

/// Both cameras from at least 3 views.
struct BoardCalibration {
    capture::StereoCalibration calibration;
    double rms = 0;  ///< of the distances between corners as found and as projected, both eyes, px
    struct View {
        double left_rms = 0;  ///< px
        double right_rms = 0;
        double rows = 0;  ///< mean |left y - right y| of the corners, rectified px
    };
    std::vector<View> views;  ///< as given
};

/// OpenCV's calibration: each eye by itself, then both together, five coefficients of distortion. Throws
/// std::invalid_argument with one line for fewer than 3 views, or ones that do not determine the cameras.
BoardCalibration calibrate(const std::vector<BoardView>& views, const Board& board, int width, int height);

}  // namespace disparityd::calibration
