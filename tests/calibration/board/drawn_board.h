// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/matx.hpp>

#include "calibration/board/board.h"
#include "calibration/calibration.h"
#include "capture/scene/scene_camera.h"

namespace disparityd::calibration::test {

/// Where the board is: its first corner and the turn of its axes, in the left camera's axes.
struct Pose {
    cv::Vec3d turn;  ///< Rodrigues
    cv::Vec3d at;    ///< mm
};

/// Draws the board as two cameras see it: traced ray by ray, 9 per pixel.
class BoardPainter {
public:
    /// `white_first`: the upper left square is white instead of black, as on ChArUco boards before OpenCV 4.6.
    BoardPainter(const StereoCalibration& cameras, const Board& board, bool white_first = false);

    /// Both eyes' grey pictures, side by side.
    std::vector<std::uint8_t> draw(const Pose& pose) const;

private:
    void draw_eye(bool right, const Pose& pose, std::vector<std::uint8_t>& picture) const;

    StereoCalibration cameras_;
    Board board_;
    bool white_first_;
    std::vector<capture::RayDirection> left_rays_;
    std::vector<capture::RayDirection> right_rays_;
};

/// A set of poses that a careful person would show: every part of the image, tilted, near and far.
std::vector<Pose> careful_poses(const Board& board);

/// What the rendered scene's cameras, of width x height, see of them: the views that find_board() finds.
std::vector<BoardView> careful_views(const Board& board, int width, int height);

}  // namespace disparityd::calibration::test
