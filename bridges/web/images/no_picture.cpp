// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/images/no_picture.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "formats/pictures/jpeg_writer.h"

namespace disparityd::web {

std::string no_picture_jpeg(int width, int height) {
    constexpr const char* words = "no picture";
    constexpr int font = cv::FONT_HERSHEY_SIMPLEX;
    constexpr double part_of_width = 0.5;
    constexpr int quality = 80;
    cv::Mat picture = cv::Mat::zeros(height, width, CV_8UC1);
    int below = 0;
    const double scale = part_of_width * width / std::max(1, cv::getTextSize(words, font, 1, 1, &below).width);
    const int thickness = std::max(1, width / 320);
    const cv::Size size = cv::getTextSize(words, font, scale, thickness, &below);
    const cv::Point at((width - size.width) / 2, (height + size.height) / 2);
    cv::putText(picture, words, at, font, scale, cv::Scalar(200), thickness, cv::LINE_AA);
    return formats::jpeg_of({picture.data, picture.cols, picture.rows, static_cast<int>(picture.step), true}, quality);
}

}  // namespace disparityd::web
