// SPDX-License-Identifier: Apache-2.0
#include "calibration/board/charuco.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/board/markers.h"

namespace disparityd::calibration {

namespace {

/// Column and row of a square.
using Square = std::pair<int, int>;
using Seen = std::map<Square, Marker>;

/// Returns the squares with a marker, in order of the numbers of the markers.
std::vector<Square> marked_squares(const Board& board, bool upper_left) {
    std::vector<Square> squares;
    for (int y = 0; y <= board.rows; ++y) {
        for (int x = 0; x <= board.columns; ++x) {
            if ((x + y) % 2 == (upper_left ? 0 : 1)) {
                squares.emplace_back(x, y);
            }
        }
    }
    return squares;
}

/// Returns the corners of a square's marker on the board, in squares from the board's outer corner.
std::array<cv::Point2f, 4> on_board(const Square& square, const Board& board) {
    const auto gap = static_cast<float>((1 - board.markers->part) / 2);
    const float left = static_cast<float>(square.first) + gap;
    const float top = static_cast<float>(square.second) + gap;
    const float right = static_cast<float>(square.first + 1) - gap;
    const float bottom = static_cast<float>(square.second + 1) - gap;
    return {cv::Point2f(left, top), cv::Point2f(right, top), cv::Point2f(right, bottom), cv::Point2f(left, bottom)};
}

double shortest_side(const Marker& marker) {
    double shortest = cv::norm(marker.corners[3] - marker.corners[0]);
    for (std::size_t i = 0; i < 3; ++i) {
        shortest = std::min(shortest, cv::norm(marker.corners[i + 1] - marker.corners[i]));
    }
    return shortest;
}

/// A marker, the square that has its number, and that square's marker on the board.
struct Candidate {
    Square square;
    Marker marker;
    std::array<cv::Point2f, 4> flat;
};

/// Fits the homography from board to image to the corners of all candidates; empty when they do not determine it.
cv::Mat to_image(const std::vector<Candidate>& candidates, int method, double tolerance) {
    std::vector<cv::Point2f> flat;
    std::vector<cv::Point2f> seen;
    for (const Candidate& candidate : candidates) {
        flat.insert(flat.end(), candidate.flat.begin(), candidate.flat.end());
        seen.insert(seen.end(), candidate.marker.corners.begin(), candidate.marker.corners.end());
    }
    return candidates.empty() ? cv::Mat() : cv::findHomography(flat, seen, method, tolerance);
}

bool fits(const Candidate& candidate, const cv::Mat& transformation, double tolerance) {
    std::vector<cv::Point2f> expected;
    cv::perspectiveTransform(std::vector<cv::Point2f>(candidate.flat.begin(), candidate.flat.end()), expected,
                             transformation);
    for (std::size_t i = 0; i < expected.size(); ++i) {
        if (cv::norm(expected[i] - candidate.marker.corners[i]) >= tolerance) {
            return false;
        }
    }
    return true;
}

/// Keeps the markers that lie where the board has them. The others were false detections.
Seen consistent(const std::vector<Marker>& markers, const std::vector<Square>& squares, const Board& board) {
    std::vector<Candidate> candidates;
    double side = 0;
    for (const Marker& marker : markers) {
        if (static_cast<std::size_t>(marker.number) < squares.size()) {
            const Square square = squares[static_cast<std::size_t>(marker.number)];
            candidates.push_back({square, marker, on_board(square, board)});
            side = std::max(side, shortest_side(marker));
        }
    }
    Seen seen;
    if (candidates.size() < 2) {
        return seen;
    }
    // The tolerance allows for lens distortion; a false detection lies a square away or more. The first fit may rest on
    // one marker, so it only selects the markers of the second fit.
    cv::Mat transformation = to_image(candidates, cv::RANSAC, side / 4);
    for (int round = 0; round < 2 && !transformation.empty(); ++round) {
        std::vector<Candidate> good;
        std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(good),
                     [&](const Candidate& candidate) { return fits(candidate, transformation, side / 2); });
        seen.clear();
        for (const Candidate& candidate : good) {
            seen.emplace(candidate.square, candidate.marker);
        }
        transformation = to_image(good, 0, 0);
    }
    return seen;
}

/// Returns where a point of the board lies in the image by the homography of one marker.
cv::Point2f seen_by(const Square& square, const Marker& marker, const Board& board, cv::Point2f point) {
    const auto flat = on_board(square, board);
    const cv::Mat to_image = cv::getPerspectiveTransform(flat.data(), marker.corners.data());
    std::vector<cv::Point2f> result;
    cv::perspectiveTransform(std::vector<cv::Point2f>{point}, result, to_image);
    return result[0];
}

/// A corner as its adjacent markers predict it, and the distance to them.
struct Guess {
    cv::Point2f at;
    double room = 11;  ///< px
};

/// Predicts a corner; nothing unless both markers are visible.
std::optional<Guess> guess(int column, int row, const Seen& seen, const Board& board) {
    const cv::Point2f corner(static_cast<float>(column + 1), static_cast<float>(row + 1));
    const double part = board.markers->part;
    Guess result;
    int markers = 0;
    for (const Square& square :
         {Square(column, row), Square(column + 1, row), Square(column, row + 1), Square(column + 1, row + 1)}) {
        if (const auto found = seen.find(square); found != seen.end()) {
            result.at += seen_by(square, found->second, board, corner) / 2;
            result.room = std::min(result.room, shortest_side(found->second) * (1 - part) / 2 / part);
            ++markers;
        }
    }
    return markers == 2 ? std::optional(result) : std::nullopt;
}

std::vector<NumberedCorner> corners_between(const cv::Mat& image, const Seen& seen, const Board& board) {
    const cv::Rect2f inside(0, 0, static_cast<float>(image.cols), static_cast<float>(image.rows));
    std::vector<NumberedCorner> corners;
    for (int row = 0; row < board.rows; ++row) {
        for (int column = 0; column < board.columns; ++column) {
            const auto found = guess(column, row, seen, board);
            if (!found || !inside.contains(found->at)) {
                continue;
            }
            const int half = std::max(2, static_cast<int>(found->room));
            std::vector<cv::Point2f> at{found->at};
            cv::cornerSubPix(image, at, {half, half}, {-1, -1},
                             {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 40, 0.001});
            corners.push_back({row * board.columns + column, at[0]});
        }
    }
    return corners;
}

}  // namespace

std::vector<NumberedCorner> find_charuco_corners(const cv::Mat& image, const Board& board) {
    const auto markers = find_markers(image, *board.markers->family);
    Seen best = consistent(markers, marked_squares(board, false), board);
    if (board.rows % 2 == 1) {
        Seen older = consistent(markers, marked_squares(board, true), board);
        if (older.size() > best.size()) {
            best = std::move(older);
        }
    }
    return corners_between(image, best, board);
}

}  // namespace disparityd::calibration
