// SPDX-License-Identifier: Apache-2.0
#include "capture/bag/bag_calibration.h"

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include "base/message_text.h"
#include "base/number_text.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/formats/rectified_eyes.h"

namespace disparityd::capture {
namespace {

using calibration::StereoCalibration;

int whole(double value) {
    constexpr double most = 65535;
    return static_cast<int>(std::clamp(value, 0.0, most));
}

std::vector<double> matrix(const formats::RosMessage& message, std::string_view field, std::size_t size) {
    const std::vector<double>& numbers = message.numbers(field);
    if (numbers.size() != size) {
        throw std::runtime_error("has " + std::to_string(numbers.size()) + " numbers in " + std::string(field) +
                                 ", expected " + std::to_string(size));
    }
    return numbers;
}

bool is_calibrated(const BagCameraInfo& info) {
    return info.camera[0] != 0;
}

std::string list(const std::string& key, const std::vector<double>& numbers) {
    std::string text = key + ": {data: [";
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        text += (i == 0 ? "" : ", ") + base::number_text(numbers[i]);
    }
    return text + "]}\n";
}

/// Returns the message as the file that ROS keeps a calibration in.
calibration::CalibrationText file_of(const BagCameraInfo& info) {
    const bool plain = std::all_of(info.model.begin(), info.model.end(),
                                   [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; });
    if (!plain) {
        calibration::refuse_calibration(info.topic, "distortion_model: found '" + base::printable(info.model) +
                                                        "', a lens model that is not known; allowed are plumb_bob, "
                                                        "rational_polynomial and equidistant");
    }
    std::string text = "image_width: " + std::to_string(info.width) + "\nimage_height: " + std::to_string(info.height) +
                       "\n" + list("camera_matrix", info.camera) + list("distortion_coefficients", info.distortion) +
                       list("rectification_matrix", info.rotation) + list("projection_matrix", info.projection);
    if (!info.model.empty()) {
        text += "distortion_model: " + info.model + "\n";
    }
    return {info.topic, std::move(text)};
}

StereoCalibration of_rectified(const BagCameraInfo& left, const BagCameraInfo& right, int width, int height) {
    for (const BagCameraInfo* info : {&left, &right}) {
        if (info->width != width || info->height != height) {
            calibration::refuse_other_size(info->topic, base::size_text(info->width, info->height), width, height);
        }
    }
    const calibration::RectifiedEyes eyes = calibration::rectified_eyes(
        {left.topic, "p", left.projection}, {right.topic, "p", right.projection}, width, height);
    StereoCalibration calibration;
    calibration.width = width;
    calibration.height = height;
    calibration.left = eyes.left;
    calibration.right = eyes.right;
    calibration.translation = {calibration::metre_mm * eyes.shift, 0, 0};
    calibration.rectified = true;
    return calibration;
}

}  // namespace

BagCameraInfo camera_info_of(const formats::RosMessage& message, const std::string& topic) {
    BagCameraInfo info;
    info.topic = topic;
    info.model = message.text("distortion_model");
    const bool capital = message.has("K");  // as ROS 1 names them
    info.distortion = message.numbers(capital ? "D" : "d");
    info.camera = matrix(message, capital ? "K" : "k", 9);
    info.rotation = matrix(message, capital ? "R" : "r", 9);
    info.projection = matrix(message, capital ? "P" : "p", 12);
    const std::int64_t part_width = message.integer("roi.width");
    const std::int64_t part_height = message.integer("roi.height");
    const std::int64_t width = part_width != 0 ? part_width : message.integer("width");
    const std::int64_t height = part_height != 0 ? part_height : message.integer("height");
    // The part is given in pixels of the whole sensor, before several of them are made one.
    const auto x = static_cast<double>(message.integer("roi.x_offset"));
    const auto y = static_cast<double>(message.integer("roi.y_offset"));
    for (std::vector<double>* numbers : {&info.camera, &info.projection}) {
        const std::size_t row = numbers->size() / 3;
        (*numbers)[2] -= x;
        (*numbers)[row + 2] -= y;
    }
    const double binning_x = static_cast<double>(std::max<std::int64_t>(1, message.integer("binning_x")));
    const double binning_y = static_cast<double>(std::max<std::int64_t>(1, message.integer("binning_y")));
    for (std::vector<double>* numbers : {&info.camera, &info.projection}) {
        const std::size_t row = numbers->size() / 3;
        for (std::size_t i = 0; i < row; ++i) {
            (*numbers)[i] /= binning_x;
            (*numbers)[row + i] /= binning_y;
        }
    }
    info.width = whole(static_cast<double>(width) / binning_x);
    info.height = whole(static_cast<double>(height) / binning_y);
    return info;
}

std::optional<StereoCalibration> calibration_of(const BagCameraInfo& left, const BagCameraInfo& right, int width,
                                                int height, bool rectified) {
    if (!is_calibrated(left) || !is_calibrated(right)) {
        return std::nullopt;
    }
    StereoCalibration calibration =
        rectified
            ? of_rectified(left, right, width, height)
            : calibration::read_ros_calibration(file_of(left), file_of(right), width, height, std::nullopt).calibration;
    calibration.origin = left.topic;
    calibration::check_plausible(calibration, left.topic);
    return calibration;
}

}  // namespace disparityd::capture
