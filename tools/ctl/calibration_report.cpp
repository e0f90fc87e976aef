// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/calibration_report.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "tools/ctl/table.h"

namespace disparityd::tools {
namespace {

constexpr int eye_width = 320;  // of a shrunk picture
constexpr int line_height = 22;
constexpr int per_row = 2;

cv::Point scaled(const cv::Point2f& corner, double scale, int shift) {
    return {static_cast<int>(corner.x * scale) + shift, static_cast<int>(corner.y * scale)};
}

void write_line(cv::Mat& picture, const std::string& text, int y) {
    cv::putText(picture, text, {6, y}, cv::FONT_HERSHEY_SIMPLEX, 0.45, {255, 255, 255}, 1, cv::LINE_AA);
}

cv::Mat view_panel(const ViewPicture& picture, const calibration::BoardView& view,
                   const calibration::BoardCalibration::View& errors, std::size_t number) {
    cv::Mat panel(picture.image.rows + line_height, picture.image.cols, CV_8UC3, cv::Scalar::all(40));
    cv::Mat shown = panel(cv::Rect(0, 0, picture.image.cols, picture.image.rows));
    cv::cvtColor(picture.image, shown, cv::COLOR_GRAY2BGR);
    for (std::size_t i = 0; i < view.left.size(); ++i) {
        const cv::Scalar colour = i == 0 ? cv::Scalar(0, 0, 255) : cv::Scalar(0, 220, 0);
        cv::circle(shown, scaled(view.left[i], picture.scale, 0), 2, colour, cv::FILLED);
        cv::circle(shown, scaled(view.right[i], picture.scale, eye_width), 2, colour, cv::FILLED);
    }
    write_line(panel,
               "view " + std::to_string(number + 1) + ": left " + fixed(errors.left_rms, 2) + " px, right " +
                   fixed(errors.right_rms, 2) + " px, rows " + fixed(errors.rows, 2) + " px",
               panel.rows - 6);
    return panel;
}

/// All corners of the left image in one place.
cv::Mat coverage_panel(const std::vector<calibration::BoardView>& views, const calibration::BoardCalibration& found,
                       cv::Size size) {
    cv::Mat panel(size, CV_8UC3, cv::Scalar::all(20));
    const auto& calibration = found.calibration;
    const double scale = static_cast<double>(eye_width) / calibration.width;
    const cv::Rect eye(0, 0, eye_width, static_cast<int>(calibration.height * scale));
    cv::rectangle(panel, eye, cv::Scalar::all(70), cv::FILLED);
    for (const calibration::BoardView& view : views) {
        for (const cv::Point2f& corner : view.left) {
            cv::circle(panel, scaled(corner, scale, 0), 1, {0, 220, 220}, cv::FILLED);
        }
    }
    cv::Mat text = panel(cv::Rect(eye_width, 0, size.width - eye_width, size.height));
    int y = line_height;
    for (const std::string& line :
         {std::to_string(views.size()) + " views, RMS " + fixed(found.rms, 3) + " px",
          "left f " + fixed(calibration.left.fx, 1) + " " + fixed(calibration.left.fy, 1) + " px",
          "right f " + fixed(calibration.right.fx, 1) + " " + fixed(calibration.right.fy, 1) + " px",
          "baseline " + fixed(-calibration.translation[0], 2) + " mm", std::string("beside: all corners, left eye")}) {
        write_line(text, line, y);
        y += line_height;
    }
    return panel;
}

}  // namespace

ViewPicture shrink(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right) {
    ViewPicture picture;
    picture.scale = static_cast<double>(eye_width) / left.width;
    const int height = std::max(1, static_cast<int>(left.height * picture.scale));
    picture.image.create(height, 2 * eye_width, CV_8U);
    int shift = 0;
    for (const auto& eye : {left, right}) {
        const cv::Mat whole(eye.height, eye.width, CV_8U, const_cast<std::uint8_t*>(eye.data),
                            static_cast<std::size_t>(eye.stride));
        cv::resize(whole, picture.image(cv::Rect(shift, 0, eye_width, height)), {eye_width, height}, 0, 0,
                   cv::INTER_AREA);
        shift += eye_width;
    }
    return picture;
}

cv::Mat report_picture(const std::vector<ViewPicture>& pictures, const std::vector<calibration::BoardView>& views,
                       const calibration::BoardCalibration& found) {
    std::vector<cv::Mat> panels;
    for (std::size_t i = 0; i < views.size(); ++i) {
        panels.push_back(view_panel(pictures[i], views[i], found.views[i], i));
    }
    const cv::Size size = panels.front().size();
    panels.push_back(coverage_panel(views, found, {size.width, std::max(size.height, 6 * line_height)}));
    const int row_height = panels.back().rows;
    const int rows = (static_cast<int>(panels.size()) + per_row - 1) / per_row;
    cv::Mat sheet(rows * row_height, per_row * size.width, CV_8UC3, cv::Scalar::all(0));
    for (std::size_t i = 0; i < panels.size(); ++i) {
        const int column = static_cast<int>(i) % per_row;
        const int row = static_cast<int>(i) / per_row;
        panels[i].copyTo(sheet(cv::Rect(column * size.width, row * row_height, panels[i].cols, panels[i].rows)));
    }
    return sheet;
}

}  // namespace disparityd::tools
