// SPDX-License-Identifier: Apache-2.0
#include "calibration/board/other_board.h"

#include <algorithm>
#include <cstddef>

#include <opencv2/calib3d.hpp>

#include "calibration/board/markers.h"
#include "calibration/grey_view.h"

namespace disparityd::calibration {
namespace {

/// So many markers are no accident of the scene.
constexpr std::size_t enough_markers = 4;

/// A chessboard has at least so many inner corners each way.
constexpr int least_corners = 3;

std::string text_of(cv::Size corners) {
    return std::to_string(corners.width) + " x " + std::to_string(corners.height);
}

struct ShownMarkers {
    const MarkerFamily* family = nullptr;  ///< nullptr: none are shown, or too few
    std::size_t count = enough_markers - 1;
};

/// Returns the markers of the family of which the image shows most.
ShownMarkers shown_markers(const cv::Mat& image) {
    ShownMarkers most;
    for (const char* name : {"4x4", "5x5", "6x6"}) {
        const MarkerFamily* family = marker_family(name);
        const std::size_t count = find_markers(image, *family).size();
        if (count > most.count) {
            most = {family, count};
        }
    }
    return most;
}

/// Returns what markers say of the board that was expected; empty: nothing.
std::string said_by(const ShownMarkers& shown, const Board& expected) {
    const std::string name(shown.family->name);
    if (!expected.markers) {
        return "the board has markers: --board charuco --dictionary " + name + ", and --marker";
    }
    if (shown.family != expected.markers->family) {
        return "the board's markers are of " + name + ", not of " + std::string(expected.markers->family->name) +
               ": --dictionary " + name;
    }
    // A board that is seen in part shows few.
    const int all = (expected.columns + 1) * (expected.rows + 1) / 2;
    return 2 * static_cast<int>(shown.count) > all
               ? "the markers are not where a board of " + text_of({expected.columns, expected.rows}) +
                     " inner corners has them: count --columns and --rows"
               : "";
}

/// Returns the inner corners of the chessboard in the image, the larger number first; 0 x 0 when there is none.
cv::Size shown_chessboard(const cv::Mat& image) {
    cv::Mat corners;
    cv::Mat grid;  // one element for each corner
    constexpr int flags = cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_LARGER;
    if (!cv::findChessboardCornersSB(image, {least_corners, least_corners}, corners, flags, grid)) {
        return {};
    }
    return {std::max(grid.cols, grid.rows), std::min(grid.cols, grid.rows)};
}

}  // namespace

void OtherBoard::look_at(Plane<const std::uint8_t> eye) {
    const cv::Mat image = grey_view(eye);
    if (const ShownMarkers markers = shown_markers(image); markers.family != nullptr) {
        if (const std::string said = said_by(markers, expected_); !said.empty()) {
            ++seen_[said];
        }
        return;
    }
    const cv::Size shown = shown_chessboard(image);
    const cv::Size expected(std::max(expected_.columns, expected_.rows), std::min(expected_.columns, expected_.rows));
    if (shown.empty()) {
        return;
    }
    if (expected_.markers) {
        ++seen_["the board has no markers: leave out --board charuco, --marker and --dictionary"];
    } else if (shown != expected) {
        ++seen_["the board has " + text_of(shown) + " inner corners, not " + text_of(expected) + ": --columns " +
                std::to_string(shown.width) + " --rows " + std::to_string(shown.height)];
    }
}

std::string OtherBoard::finding() const {
    const auto most =
        std::max_element(seen_.begin(), seen_.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    return most != seen_.end() && most->second >= enough_frames_ ? most->first : "";
}

}  // namespace disparityd::calibration
