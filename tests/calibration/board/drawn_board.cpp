// SPDX-License-Identifier: Apache-2.0
#include "tests/calibration/board/drawn_board.h"

#include <cmath>

#include <opencv2/calib3d.hpp>

namespace disparityd::calibration::test {

namespace {

constexpr int finer = 3;

constexpr double black = 35;
constexpr double white = 220;

/// The grey within a white square with a marker; u and v from 0 to 1.
double marker_shade(const Board& board, int column, int row, double u, double v) {
    const MarkerFamily& family = *board.markers->family;
    const double part = board.markers->part;
    const auto cell = [&](double place) {
        return static_cast<int>(std::floor((place - (1 - part) / 2) / part * (family.side + 2)));
    };
    const int x = cell(u);
    const int y = cell(v);
    if (x < 0 || y < 0 || x > family.side + 1 || y > family.side + 1) {
        return white;
    }
    if (x == 0 || y == 0 || x == family.side + 1 || y == family.side + 1) {
        return black;
    }
    const int number = (row * (board.columns + 1) + column) / 2;
    const int bit = family.side * family.side - 1 - ((y - 1) * family.side + x - 1);
    return (family.codes[static_cast<std::size_t>(number)] >> static_cast<unsigned>(bit) & 1U) != 0 ? white : black;
}

/// The grey of the place that a ray from `from` meets; the board has a white rim of a square.
double shade(const Board& board, bool white_first, const cv::Matx33d& turn, const cv::Vec3d& at, const cv::Vec3d& from,
             const cv::Vec3d& ray) {
    const cv::Vec3d normal(turn(0, 2), turn(1, 2), turn(2, 2));
    const double reach = normal.dot(at - from) / normal.dot(ray);
    const cv::Vec3d place = turn.t() * (from + reach * ray - at);
    const double x = place[0] / board.square_mm + 1;  // in squares, from the outer corner
    const double y = place[1] / board.square_mm + 1;
    if (reach <= 0 || x < -1 || y < -1 || x > board.columns + 2 || y > board.rows + 2) {
        return 90;
    }
    const bool rim = x < 0 || y < 0 || x > board.columns + 1 || y > board.rows + 1;
    const int column = static_cast<int>(std::floor(x));
    const int row = static_cast<int>(std::floor(y));
    if (rim) {
        return white;
    }
    if ((column + row) % 2 == (white_first ? 1 : 0)) {
        return black;
    }
    return board.markers ? marker_shade(board, column, row, x - column, y - row) : white;
}

}  // namespace

BoardPainter::BoardPainter(const StereoCalibration& cameras, const Board& board, bool white_first)
    : cameras_(cameras), board_(board), white_first_(white_first) {
    // The same camera with finer pixels, whose centres lie around those of the coarse ones.
    const auto fine = [&](CameraModel camera) {
        camera.fx *= finer;
        camera.fy *= finer;
        camera.cx = finer * camera.cx + (finer - 1) / 2.0;
        camera.cy = finer * camera.cy + (finer - 1) / 2.0;
        return capture::pixel_rays(camera, finer * cameras.width, finer * cameras.height);
    };
    left_rays_ = fine(cameras.left);
    right_rays_ = fine(cameras.right);
}

std::vector<std::uint8_t> BoardPainter::draw(const Pose& pose) const {
    std::vector<std::uint8_t> picture(2 * static_cast<std::size_t>(cameras_.width) *
                                      static_cast<std::size_t>(cameras_.height));
    draw_eye(false, pose, picture);
    draw_eye(true, pose, picture);
    return picture;
}

void BoardPainter::draw_eye(bool right, const Pose& pose, std::vector<std::uint8_t>& picture) const {
    cv::Matx33d turn;
    cv::Rodrigues(pose.turn, turn);
    const cv::Matx33d back = right ? cv::Matx33d(cameras_.rotation.data()).t() : cv::Matx33d::eye();
    const cv::Vec3d from = right ? -(back * cv::Vec3d(cameras_.translation.data())) : cv::Vec3d();
    const auto& rays = right ? right_rays_ : left_rays_;
    for (int y = 0; y < cameras_.height; ++y) {
        for (int x = 0; x < cameras_.width; ++x) {
            double sum = 0;
            for (int i = 0; i < finer * finer; ++i) {
                const auto& ray = rays[static_cast<std::size_t>(finer * y + i / finer) *
                                           static_cast<std::size_t>(finer * cameras_.width) +
                                       static_cast<std::size_t>(finer * x + i % finer)];
                sum += shade(board_, white_first_, turn, pose.at, from, back * cv::Vec3d(ray.x, ray.y, 1));
            }
            picture[static_cast<std::size_t>(y) * 2 * static_cast<std::size_t>(cameras_.width) +
                    static_cast<std::size_t>(x + (right ? cameras_.width : 0))] =
                static_cast<std::uint8_t>(std::lround(sum / (finer * finer)));
        }
    }
}

std::vector<Pose> careful_poses(const Board& board) {
    const double width = (board.columns - 1) * board.square_mm;
    const double height = (board.rows - 1) * board.square_mm;
    std::vector<Pose> poses;
    const auto show = [&](double x, double y, double z, cv::Vec3d turn) {
        cv::Matx33d rotation;
        cv::Rodrigues(turn, rotation);
        const cv::Vec3d middle = rotation * cv::Vec3d(width / 2, height / 2, 0);
        poses.push_back({turn, cv::Vec3d(x * z, y * z, z) - middle});
    };
    const double far = 2.6 * width;
    for (const double x : {-0.5, 0.1, 0.6}) {
        for (const double y : {-0.3, 0.0, 0.3}) {
            show(x, y, far, {0.5 * y, -0.6 * x, 0.2 * x * y});
        }
    }
    show(0.15, 0, 1.4 * width, {0.35, 0.2, 0.05});
    show(0.15, 0, 1.4 * width, {-0.4, 0.1, -0.1});
    show(0.12, 0.03, 1.5 * width, {0.1, 0.5, 0});
    show(0.12, -0.03, 1.5 * width, {0.1, -0.5, 0.1});
    return poses;
}

std::vector<BoardView> careful_views(const Board& board, int width, int height) {
    const BoardPainter painter(capture::scene_calibration(width, height), board);
    std::vector<BoardView> views;
    for (const Pose& pose : careful_poses(board)) {
        const auto picture = painter.draw(pose);
        if (const auto view = find_board({picture.data(), width, height, 2 * width},
                                         {picture.data() + width, width, height, 2 * width}, board)) {
            views.push_back(*view);
        }
    }
    return views;
}

}  // namespace disparityd::calibration::test
