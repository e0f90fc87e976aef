// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/calibration/calibration_report.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "base/words.h"
#include "calibration/grey_view.h"
#include "tools/command_line/table.h"

namespace disparityd::tools {
namespace {

constexpr int eye_width = 320;  // of a shrunk picture
constexpr int line_height = 22;
constexpr int per_row = 2;
constexpr int font = cv::FONT_HERSHEY_SIMPLEX;
constexpr double font_scale = 0.45;

cv::Point scaled(const cv::Point2f& corner, double scale, int shift) {
    return {static_cast<int>(corner.x * scale) + shift, static_cast<int>(corner.y * scale)};
}

void write_line(cv::Mat& picture, const std::string& text, int y) {
    cv::putText(picture, text, {6, y}, font, font_scale, {255, 255, 255}, 1, cv::LINE_AA);
}

/// Returns the end of a text that is too long for `width`: names differ at their ends.
std::string fitted_line(const std::string& text, int width) {
    const auto too_wide = [width](const std::string& line) {
        return cv::getTextSize(line, font, font_scale, 1, nullptr).width > width;
    };
    std::string line = text;
    for (std::size_t cut = 1; too_wide(line) && cut < text.size(); ++cut) {
        line = "..." + text.substr(cut);
    }
    return line;
}

cv::Mat view_panel(const ViewPicture& picture, const calibration::BoardView& view,
                   const calibration::BoardCalibration::View& errors, const std::string& label) {
    cv::Mat panel(picture.image.rows + 2 * line_height, picture.image.cols, CV_8UC3, cv::Scalar::all(40));
    cv::Mat shown = panel(cv::Rect(0, 0, picture.image.cols, picture.image.rows));
    cv::cvtColor(picture.image, shown, cv::COLOR_GRAY2BGR);
    for (std::size_t i = 0; i < view.left.size(); ++i) {
        const cv::Scalar colour = i == 0 ? cv::Scalar(0, 0, 255) : cv::Scalar(0, 220, 0);
        cv::circle(shown, scaled(view.left[i], picture.scale, 0), 2, colour, cv::FILLED);
        cv::circle(shown, scaled(view.right[i], picture.scale, eye_width), 2, colour, cv::FILLED);
    }
    write_line(panel, fitted_line(label + ": " + picture.frame, panel.cols - 12), panel.rows - line_height - 6);
    write_line(panel,
               "left " + fixed(errors.left_rms, 2) + " px, right " + fixed(errors.right_rms, 2) + " px, rows " +
                   fixed(errors.rows, 2) + " px",
               panel.rows - 6);
    return panel;
}

/// Draws all corners of an eye in one picture; parts of the image without one are red.
void draw_coverage(cv::Mat picture, const calibration::EyeCoverage& coverage,
                   const std::vector<calibration::BoardView>& views,
                   std::vector<cv::Point2f> calibration::BoardView::*corners, int captured_width) {
    const double scale = static_cast<double>(picture.cols) / captured_width;
    constexpr int side = calibration::coverage_side;
    for (int part = 0; part < side * side; ++part) {
        const cv::Point from(part % side * picture.cols / side, part / side * picture.rows / side);
        const cv::Point to((part % side + 1) * picture.cols / side, (part / side + 1) * picture.rows / side);
        const bool seen = coverage.parts[static_cast<std::size_t>(part)];
        cv::rectangle(picture, cv::Rect(from, to), seen ? cv::Scalar::all(70) : cv::Scalar(40, 40, 170), cv::FILLED);
        cv::rectangle(picture, cv::Rect(from, to), cv::Scalar::all(120));
    }
    for (const calibration::BoardView& view : views) {
        for (const cv::Point2f& corner : view.*corners) {
            cv::circle(picture, scaled(corner, scale, 0), 1, {0, 220, 220}, cv::FILLED);
        }
    }
}

std::vector<std::string> summary_lines(const calibration::CheckedCalibration& checked) {
    const calibration::StereoCalibration& cameras = checked.found.calibration;
    std::vector<std::string> lines{std::string("verdict: ") + to_string(checked.judgement.verdict),
                                   base::counted(checked.views.size(), "view") + ", RMS " +
                                       fixed(checked.found.rms, 3) + " px, baseline " +
                                       fixed(-cameras.translation[0], 2) + " mm, focal length: left " +
                                       fixed(cameras.left.fx, 1) + " px, right " + fixed(cameras.right.fx, 1) + " px",
                                   coverage_line(checked.judgement.coverage),
                                   "above: all corners in the left and the right image; a red part has none"};
    for (const std::string& line : checked.judgement.reasons) {
        lines.push_back("- " + line);
    }
    for (const std::string& line : checked.judgement.missing) {
        lines.push_back("- to be better: " + line);
    }
    return lines;
}

cv::Mat summary_panel(const calibration::CheckedCalibration& checked, int width) {
    const calibration::StereoCalibration& cameras = checked.found.calibration;
    const calibration::Coverage& coverage = checked.judgement.coverage;
    const std::vector<std::string> lines = summary_lines(checked);
    const int eye_height = eye_width * cameras.height / cameras.width;
    const int text_height = (static_cast<int>(lines.size()) + 1) * line_height;
    cv::Mat panel(eye_height + text_height, width, CV_8UC3, cv::Scalar::all(20));
    draw_coverage(panel(cv::Rect(0, 0, eye_width, eye_height)), coverage.left, checked.views,
                  &calibration::BoardView::left, cameras.width);
    draw_coverage(panel(cv::Rect(eye_width + 4, 0, eye_width, eye_height)), coverage.right, checked.views,
                  &calibration::BoardView::right, cameras.width);
    cv::Mat text = panel.rowRange(eye_height, panel.rows);
    int y = line_height;
    for (const std::string& line : lines) {
        write_line(text, line, y);
        y += line_height;
    }
    return panel;
}

}  // namespace

std::string coverage_line(const calibration::Coverage& coverage) {
    return "coverage: the boards covered " + fixed(100 * coverage.left.ratio, 0) + " % of the left eye's image, " +
           fixed(100 * coverage.right.ratio, 0) + " % of the right eye's";
}

ViewPicture shrink(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right) {
    ViewPicture picture;
    picture.scale = static_cast<double>(eye_width) / left.width;
    const int height = std::max(1, static_cast<int>(left.height * picture.scale));
    picture.image.create(height, 2 * eye_width, CV_8U);
    int shift = 0;
    for (const auto& eye : {left, right}) {
        cv::resize(calibration::grey_view(eye), picture.image(cv::Rect(shift, 0, eye_width, height)),
                   {eye_width, height}, 0, 0, cv::INTER_AREA);
        shift += eye_width;
    }
    return picture;
}

cv::Mat report_picture(const std::vector<ViewPicture>& pictures, const std::vector<calibration::BoardView>& views,
                       const calibration::CheckedCalibration& checked) {
    const int width = per_row * 2 * eye_width;
    const cv::Mat summary = summary_panel(checked, width);
    std::vector<cv::Mat> panels;
    for (std::size_t i = 0; i < checked.used.size(); ++i) {
        const std::size_t view = checked.used[i];
        panels.push_back(
            view_panel(pictures[view], views[view], checked.found.views[i], "view " + std::to_string(view + 1)));
    }
    for (const auto& [view, errors] : checked.left_out) {
        panels.push_back(view_panel(pictures[view], views[view], errors, "LEFT OUT: view " + std::to_string(view + 1)));
    }
    const int row_height = panels.front().rows;
    const int rows = (static_cast<int>(panels.size()) + per_row - 1) / per_row;
    cv::Mat sheet(summary.rows + rows * row_height, width, CV_8UC3, cv::Scalar::all(0));
    summary.copyTo(sheet.rowRange(0, summary.rows));
    for (std::size_t i = 0; i < panels.size(); ++i) {
        const int column = static_cast<int>(i) % per_row;
        const int row = static_cast<int>(i) / per_row;
        const cv::Point corner(column * 2 * eye_width, summary.rows + row * row_height);
        panels[i].copyTo(sheet(cv::Rect(corner, panels[i].size())));
    }
    return sheet;
}

}  // namespace disparityd::tools
