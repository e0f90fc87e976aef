// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "tests/formats/mcap_writer.h"

namespace disparityd::test {

/// A time of day at which bags begin, ns since 1970.
inline constexpr std::int64_t bag_start_ns = 1'700'000'000'000'000'000;

/// The fields of a sensor_msgs/msg/CameraInfo that the tests change.
struct CameraInfoFields {
    int width = 64;
    int height = 48;
    std::string model = "plumb_bob";
    std::vector<double> distortion{0.1, -0.05, 0.001, 0.002, 0.01};
    std::array<double, 9> k{60, 0, 31, 0, 60, 23, 0, 0, 1};
    std::array<double, 9> r{1, 0, 0, 0, 1, 0, 0, 0, 1};
    std::array<double, 12> p{58, 0, 32, 0, 0, 58, 24, 0, 0, 0, 1, 0};
    unsigned binning = 0;
    std::array<unsigned, 4> roi{};  ///< x, y, height, width

    /// Of the right camera, so far beside the left one.
    CameraInfoFields right_of(double baseline_m) const;
};

/// A transform of /tf_static, which takes points of the child to the parent.
struct TransformFields {
    std::string parent;
    std::string child;
    std::array<double, 3> translation_m{};
    std::array<double, 4> rotation{0, 0, 0, 1};  ///< x, y, z, w
};

/// Makes a bag of ROS 2 as a text in memory.
class BagWriter {
public:
    explicit BagWriter(McapFeatures features = {}) : writer_(std::move(features)) {}

    /// Adds a sensor_msgs/msg/Image whose rows have `gap` bytes more than they need.
    void image(const std::string& topic, std::int64_t stamp_ns, const cv::Mat& pixels, const std::string& encoding,
               int gap = 0);
    void compressed(const std::string& topic, std::int64_t stamp_ns, const std::string& format, std::string_view file);
    void camera_info(const std::string& topic, std::int64_t stamp_ns, const CameraInfoFields& fields);
    void transforms(std::int64_t stamp_ns, const std::vector<TransformFields>& transforms);
    void imu(const std::string& topic, std::int64_t stamp_ns, double turn, double pull);

    std::string close() { return writer_.close(); }

private:
    std::uint16_t channel(const std::string& topic, std::string_view type, std::string_view definition);
    void message(std::uint16_t channel, std::int64_t stamp_ns, const std::string& data);

    McapWriter writer_;
    std::map<std::string, std::uint16_t> channels_;
    std::uint32_t sequence_ = 0;
};

/// Messages of ROS 1, and how it defines their types.
extern const std::string_view ros1_image_type;
extern const std::string_view ros1_camera_info_type;
std::string ros1_image(std::int64_t stamp_ns, const cv::Mat& grey);
std::string ros1_camera_info(std::int64_t stamp_ns, const CameraInfoFields& fields);

}  // namespace disparityd::test
