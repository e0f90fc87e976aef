// SPDX-License-Identifier: Apache-2.0
#include "calibration/board/board.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <set>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "base/words.h"
#include "calibration/board/charuco.h"
#include "calibration/grey_view.h"

namespace disparityd::calibration {

namespace {

bool find_in(const cv::Mat& image, const Board& board, std::vector<cv::Point2f>& corners) {
    const cv::Size size(board.columns, board.rows);
    // CALIB_CB_FAST_CHECK is left out: it misses boards with squares of less than about 20 pixels.
    constexpr int flags = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE;
    if (!cv::findChessboardCorners(image, size, corners, flags)) {
        return false;
    }
    // The window must not reach the next corner.
    double nearest = image.cols;
    for (std::size_t i = 1; i < corners.size(); ++i) {
        if (i % static_cast<std::size_t>(board.columns) != 0) {
            nearest = std::min(nearest, cv::norm(corners[i] - corners[i - 1]));
        }
    }
    const int half = std::clamp(static_cast<int>(nearest / 3), 2, 11);
    cv::cornerSubPix(image, corners, {half, half}, {-1, -1},
                     {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 40, 0.001});
    return true;
}

std::vector<cv::Point3f> board_points(const Board& board, const std::vector<int>& numbers) {
    std::vector<cv::Point3f> points;
    points.reserve(numbers.size());
    for (const cv::Point2f& place : places_on(board, numbers)) {
        points.emplace_back(static_cast<float>(place.x * board.square_mm),
                            static_cast<float>(place.y * board.square_mm), 0.0F);
    }
    return points;
}

CameraModel camera_of(const cv::Mat& matrix, const cv::Mat& distortion) {
    CameraModel camera{
        matrix.at<double>(0, 0), matrix.at<double>(1, 1), matrix.at<double>(0, 2), matrix.at<double>(1, 2), {}};
    const cv::Mat flat = distortion.reshape(1, 1);
    std::copy_n(flat.ptr<double>(), std::min<int>(14, flat.cols), camera.distortion.begin());
    camera.lens = flat.cols == 4 ? LensModel::fisheye : LensModel::pinhole;
    return camera;
}

using Corners = std::vector<cv::Point2f>;

/// Fits one fisheye eye, and takes its corners to where a pinhole with the same matrix sees them.
void fit_fisheye(const std::vector<std::vector<cv::Point3f>>& points, std::vector<Corners>& corners, cv::Size size,
                 cv::Mat& matrix, cv::Mat& lens) {
    std::vector<cv::Mat> turns;
    std::vector<cv::Mat> shifts;
    cv::fisheye::calibrate(points, corners, size, matrix, lens, turns, shifts,
                           cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC | cv::fisheye::CALIB_FIX_SKEW,
                           {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-6});
    for (Corners& seen : corners) {
        cv::fisheye::undistortPoints(Corners(seen), seen, matrix, lens, cv::noArray(), matrix);
    }
}

/// Input and output of stereoCalibrate().
struct Cameras {
    cv::Mat left, left_distortion, right, right_distortion, rotation, translation;
};

/// Measures the mean difference of the rows of the corners after rectification, for each view.
void measure_rows(const Cameras& cameras, const std::vector<Corners>& lefts, const std::vector<Corners>& rights,
                  cv::Size size, std::vector<BoardCalibration::View>& results) {
    cv::Mat left_turn, right_turn, left_projection, right_projection, to_depth;
    cv::stereoRectify(cameras.left, cameras.left_distortion, cameras.right, cameras.right_distortion, size,
                      cameras.rotation, cameras.translation, left_turn, right_turn, left_projection, right_projection,
                      to_depth, cv::CALIB_ZERO_DISPARITY, 0);
    for (std::size_t i = 0; i < lefts.size(); ++i) {
        Corners left;
        Corners right;
        cv::undistortPoints(lefts[i], left, cameras.left, cameras.left_distortion, left_turn, left_projection);
        cv::undistortPoints(rights[i], right, cameras.right, cameras.right_distortion, right_turn, right_projection);
        double sum = 0;
        for (std::size_t k = 0; k < left.size(); ++k) {
            sum += std::abs(left[k].y - right[k].y);
        }
        results[i].rows = sum / static_cast<double>(left.size());
    }
}

/// Returns whether corners lie as on a flat board seen through any lens: with a wrong number of columns or rows the
/// markers' numbers put them elsewhere.
bool lie_as_on(const Board& board, const BoardView& view) {
    constexpr double most_squares = 0.75;  // a fisheye bends the lines of a large board by half of one
    const std::vector<cv::Point2f> flat = places_on(board, view.numbers);
    const cv::Mat to_board = cv::findHomography(view.left, flat);
    if (to_board.empty()) {
        return false;
    }
    std::vector<cv::Point2f> found;
    cv::perspectiveTransform(view.left, found, to_board);
    double squares = 0;
    for (std::size_t i = 0; i < flat.size(); ++i) {
        squares += (found[i] - flat[i]).dot(found[i] - flat[i]);
    }
    return squares <= most_squares * most_squares * static_cast<double>(flat.size());
}

/// Finds the corners that both eyes see. Markers give their numbers, so the eyes may see different parts of the board.
std::optional<BoardView> find_charuco(const cv::Mat& left, const cv::Mat& right, const Board& board) {
    constexpr std::size_t least = 8;
    const auto seen_left = find_charuco_corners(left, board);
    const auto seen_right = find_charuco_corners(right, board);
    BoardView view;
    std::set<int> rows;
    std::set<int> columns;
    auto other = seen_right.begin();
    for (const NumberedCorner& corner : seen_left) {
        while (other != seen_right.end() && other->number < corner.number) {
            ++other;
        }
        if (other != seen_right.end() && other->number == corner.number) {
            view.left.push_back(corner.at);
            view.right.push_back(other->at);
            view.numbers.push_back(corner.number);
            rows.insert(corner.number / board.columns);
            columns.insert(corner.number % board.columns);
        }
    }
    if (view.numbers.size() < least || rows.size() < 2 || columns.size() < 2 || !lie_as_on(board, view)) {
        return std::nullopt;
    }
    return view;
}

}  // namespace

std::vector<cv::Point2f> places_on(const Board& board, const std::vector<int>& numbers) {
    std::vector<cv::Point2f> places;
    places.reserve(numbers.size());
    for (const int number : numbers) {
        places.emplace_back(static_cast<float>(number % board.columns), static_cast<float>(number / board.columns));
    }
    return places;
}

std::optional<BoardView> find_board(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right,
                                    const Board& board) {
    if (board.markers) {
        return find_charuco(grey_view(left), grey_view(right), board);
    }
    BoardView view;
    if (!find_in(grey_view(left), board, view.left) || !find_in(grey_view(right), board, view.right)) {
        return std::nullopt;
    }
    // Both eyes see the same side up, but a board that looks the same upside down may have been read either way.
    if ((view.left.back() - view.left.front()).dot(view.right.back() - view.right.front()) < 0) {
        std::reverse(view.right.begin(), view.right.end());
    }
    view.numbers.resize(view.left.size());
    std::iota(view.numbers.begin(), view.numbers.end(), 0);
    return view;
}

double moved(const BoardView& before, const BoardView& after) {
    double sum = 0;
    int common = 0;
    for (std::size_t i = 0; i < before.numbers.size(); ++i) {
        const auto same = std::lower_bound(after.numbers.begin(), after.numbers.end(), before.numbers[i]);
        if (same != after.numbers.end() && *same == before.numbers[i]) {
            const auto k = static_cast<std::size_t>(same - after.numbers.begin());
            sum += cv::norm(after.left[k] - before.left[i]);
            ++common;
        }
    }
    return common == 0 ? std::numeric_limits<double>::infinity() : sum / common;
}

BoardCalibration calibrate(const std::vector<BoardView>& views, const Board& board, int width, int height,
                           BoardLens lens) {
    if (views.size() < 3) {
        throw std::invalid_argument("calibrate: the board is seen by both eyes in " +
                                    base::counted(views.size(), "view") + ", at least 3 are needed, 15 are better");
    }
    std::vector<std::vector<cv::Point3f>> points;
    std::vector<Corners> left;
    std::vector<Corners> right;
    for (const BoardView& view : views) {
        points.push_back(board_points(board, view.numbers));
        left.push_back(view.left);
        right.push_back(view.right);
    }
    const cv::Size size(width, height);
    Cameras cameras;
    cv::Mat left_lens, right_lens;
    const bool fisheye = lens == BoardLens::fisheye;
    const int model = lens == BoardLens::rational ? cv::CALIB_RATIONAL_MODEL : 0;
    BoardCalibration result;
    try {
        if (fisheye) {
            fit_fisheye(points, left, size, cameras.left, left_lens);
            fit_fisheye(points, right, size, cameras.right, right_lens);
        } else {
            std::vector<cv::Mat> turns;
            std::vector<cv::Mat> shifts;
            cv::calibrateCamera(points, left, size, cameras.left, cameras.left_distortion, turns, shifts, model);
            cv::calibrateCamera(points, right, size, cameras.right, cameras.right_distortion, turns, shifts, model);
        }
        cv::Mat essential, fundamental, errors;
        const cv::TermCriteria precise(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-6);
        result.rms = cv::stereoCalibrate(
            points, left, right, cameras.left, cameras.left_distortion, cameras.right, cameras.right_distortion, size,
            cameras.rotation, cameras.translation, essential, fundamental, errors,
            fisheye ? cv::CALIB_FIX_INTRINSIC : cv::CALIB_USE_INTRINSIC_GUESS | model, precise);
        for (int i = 0; i < errors.rows; ++i) {
            result.views.push_back({errors.at<double>(i, 0), errors.at<double>(i, 1), 0});
        }
        measure_rows(cameras, left, right, size, result.views);
    } catch (const cv::Exception&) {
        throw std::invalid_argument(
            "calibrate: the views do not determine the cameras: show the board from more sides, tilted, near and far");
    }
    result.calibration.width = width;
    result.calibration.height = height;
    result.calibration.left = camera_of(cameras.left, fisheye ? left_lens : cameras.left_distortion);
    result.calibration.right = camera_of(cameras.right, fisheye ? right_lens : cameras.right_distortion);
    std::copy_n(cameras.rotation.ptr<double>(), 9, result.calibration.rotation.begin());
    std::copy_n(cameras.translation.ptr<double>(), 3, result.calibration.translation.begin());
    result.calibration.origin = "calibrate";
    return result;
}

}  // namespace disparityd::calibration
