// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "calibration/board/marker_codes.h"
#include "calibration/calibration.h"
#include "kernels/image.h"

namespace disparityd::calibration {

/// The markers in the white squares of a ChArUco board.
struct BoardMarkers {
    const MarkerFamily* family = nullptr;  ///< see marker_family()
    double part = 0.7;                     ///< side of a marker divided by that of a square
};

/// A chessboard by its inner corners: a board of 10 x 7 squares has 9 x 6 of them.
struct Board {
    int columns = 9;
    int rows = 6;
    double square_mm = 25;
    std::optional<BoardMarkers> markers{};  ///< none: a plain chessboard
};

/// The corners that both eyes see, in the same order; px.
struct BoardView {
    std::vector<cv::Point2f> left;
    std::vector<cv::Point2f> right;
    std::vector<int> numbers;  ///< which of the board's corners, row by row, ascending
};

/// Returns where corners lie on a board, in squares from the first one, by their numbers.
std::vector<cv::Point2f> places_on(const Board& board, const std::vector<int>& numbers);

/// Finds a board in both eyes, with subpixel corners. Both eyes must see a whole chessboard; of a board with markers,
/// eight common corners in two rows and columns suffice. Returns nothing when an eye sees less.
std::optional<BoardView> find_board(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right,
                                    const Board& board);

/// Returns how far the corners have moved between two views: the mean distance of the common corners in the left eye,
/// px; infinite when there are none.
double moved(const BoardView& before, const BoardView& after);

/// The result of calibrate().
struct BoardCalibration {
    StereoCalibration calibration;
    double rms = 0;  ///< of the reprojection errors of both eyes, px
    struct View {
        double left_rms = 0;  ///< px
        double right_rms = 0;
        double rows = 0;  ///< mean |left y - right y| of the corners, rectified px
    };
    std::vector<View> views;  ///< as given
};

/// The lens model that a calibration finds.
enum class BoardLens {
    brown,     ///< k1 k2 p1 p2 k3
    rational,  ///< 8 coefficients, for wide pinholes; needs views up to the edges
    fisheye,   ///< equidistant, k1 to k4
};

/// Calibrates both cameras by OpenCV: each eye by itself, then both together. Of fisheye lenses only the pose is found
/// together; errors are px of pinholes with the same focal length. Throws std::invalid_argument with one line when
/// there are fewer than 3 views or they do not determine the cameras.
BoardCalibration calibrate(const std::vector<BoardView>& views, const Board& board, int width, int height,
                           BoardLens lens = BoardLens::brown);

}  // namespace disparityd::calibration
