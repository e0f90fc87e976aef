// SPDX-License-Identifier: Apache-2.0
#include "calibration/board/coverage.h"

#include <algorithm>
#include <cmath>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace disparityd::calibration {
namespace {

// A good set of views has these, and corners in every part of the images.
constexpr std::size_t enough_tilted = 3;
constexpr double tilted = 1.12;  // opposite sides of the board differ by so much
constexpr double near = 0.35;    // of the image's width

/// The covered part of an image is counted in a picture of this width.
constexpr int counted_width = 320;

const char* part_name(std::size_t part) {
    static constexpr std::array<const char*, coverage_parts> names{"upper left", "upper middle", "upper right",
                                                                   "left",       "middle",       "right",
                                                                   "lower left", "lower middle", "lower right"};
    return names[part];
}

EyeCoverage coverage_of_eye(const std::vector<BoardView>& views, std::vector<cv::Point2f> BoardView::*corners,
                            int width, int height) {
    EyeCoverage coverage;
    const double scale = static_cast<double>(counted_width) / width;
    cv::Mat covered = cv::Mat::zeros(std::max(1, static_cast<int>(std::lround(height * scale))), counted_width, CV_8U);
    for (const BoardView& view : views) {
        std::vector<cv::Point> outline;
        for (const cv::Point2f& corner : view.*corners) {
            const int column = std::clamp(static_cast<int>(corner.x) * coverage_side / width, 0, coverage_side - 1);
            const int row = std::clamp(static_cast<int>(corner.y) * coverage_side / height, 0, coverage_side - 1);
            coverage.parts[static_cast<std::size_t>(row * coverage_side + column)] = true;
            outline.emplace_back(static_cast<int>(std::lround(corner.x * scale)),
                                 static_cast<int>(std::lround(corner.y * scale)));
        }
        std::vector<cv::Point> hull;
        cv::convexHull(outline, hull);
        cv::fillConvexPoly(covered, hull, 1);
    }
    coverage.ratio = static_cast<double>(cv::countNonZero(covered)) / static_cast<double>(covered.total());
    return coverage;
}

/// Returns the largest ratio of two opposite sides of the board in the left eye, at least 1.
double tilt(const BoardView& view, const Board& board) {
    const cv::Mat to_image = cv::findHomography(places_on(board, view.numbers), view.left);
    if (to_image.empty()) {
        return 1;
    }
    const auto right = static_cast<float>(board.columns - 1);
    const auto bottom = static_cast<float>(board.rows - 1);
    std::vector<cv::Point2f> outer;
    cv::perspectiveTransform(std::vector<cv::Point2f>{{0, 0}, {right, 0}, {0, bottom}, {right, bottom}}, outer,
                             to_image);
    const auto [a, b, c, d] = std::array{outer[0], outer[1], outer[2], outer[3]};
    const auto ratio = [](double first, double second) { return std::max(first, second) / std::min(first, second); };
    return std::max(ratio(cv::norm(a - b), cv::norm(c - d)), ratio(cv::norm(a - c), cv::norm(b - d)));
}

}  // namespace

Coverage coverage_of(const std::vector<BoardView>& views, int width, int height) {
    return {coverage_of_eye(views, &BoardView::left, width, height),
            coverage_of_eye(views, &BoardView::right, width, height)};
}

std::vector<std::string> missing_parts(const Coverage& coverage) {
    std::vector<std::string> missing;
    const auto hold_into = [&](std::size_t part, const char* image) {
        missing.push_back(std::string("hold the board into the ") + part_name(part) + " part of the " + image);
    };
    for (std::size_t part = 0; part < coverage_parts; ++part) {
        if (!coverage.left.parts[part] && !coverage.right.parts[part]) {
            hold_into(part, "image");
        }
    }
    for (std::size_t part = 0; part < coverage_parts; ++part) {
        if (coverage.left.parts[part] != coverage.right.parts[part]) {
            hold_into(part, coverage.left.parts[part] ? "right eye's image" : "left eye's image");
        }
    }
    return missing;
}

std::vector<std::string> missing_poses(const std::vector<BoardView>& views, const Board& board, int width) {
    std::size_t tilted_views = 0;
    double widest = 0;
    for (const BoardView& view : views) {
        const cv::Rect2f box = cv::boundingRect(view.left);
        widest = std::max(widest, static_cast<double>(box.width) / width);
        tilted_views += tilt(view, board) > tilted ? 1 : 0;
    }
    std::vector<std::string> missing;
    if (widest < near) {
        missing.emplace_back("hold the board nearer, until it fills more than a third of the width");
    }
    if (tilted_views < enough_tilted) {
        missing.push_back("tilt the board by about 30 degrees: " + std::to_string(tilted_views) + " of " +
                          std::to_string(enough_tilted) + " views show it tilted");
    }
    return missing;
}

std::vector<std::string> missing_views(const std::vector<BoardView>& views, const Board& board, int width, int height) {
    std::vector<std::string> missing = missing_parts(coverage_of(views, width, height));
    const std::vector<std::string> poses = missing_poses(views, board, width);
    missing.insert(missing.end(), poses.begin(), poses.end());
    return missing;
}

}  // namespace disparityd::calibration
