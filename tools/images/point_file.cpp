// SPDX-License-Identifier: Apache-2.0
#include "tools/images/point_file.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace disparityd::images {
namespace {

static_assert(std::endian::native == std::endian::little, "points are written as they lie in memory");

struct Colour {
    std::uint8_t red, green, blue;
};

Colour colour_at(const cv::Mat& left, int x, int y) {
    if (left.channels() == 1) {
        const std::uint8_t grey = left.at<std::uint8_t>(y, x);
        return {grey, grey, grey};
    }
    const auto& bgr = left.at<cv::Vec3b>(y, x);
    return {bgr[2], bgr[1], bgr[0]};
}

template <typename T>
void append(std::string& bytes, T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes.append(raw, sizeof(T));
}

std::string head(const std::string& format, std::size_t count) {
    const std::string number = std::to_string(count);
    if (format == "ply") {
        return "ply\nformat binary_little_endian 1.0\ncomment metres; x right, y down, z ahead\nelement vertex " +
               number +
               "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
               "property uchar blue\nend_header\n";
    }
    return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH " + number +
           "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + number + "\nDATA binary\n";
}

}  // namespace

std::string point_file(const std::string& format, const DisparityMap& map, const PointCamera& camera,
                       const cv::Mat& left) {
    std::string points;
    std::size_t count = 0;
    for (int y = 0; y < map.d16.height; ++y) {
        const std::int16_t* const row = map.d16.row(y);
        for (int x = 0; x < map.d16.width; ++x) {
            const double z = row[x] == map.invalid() ? INFINITY : camera.metric.metres(row[x] / 16.0);
            if (!std::isfinite(z)) {
                continue;
            }
            ++count;
            append(points, static_cast<float>((x - camera.cx) * z / camera.metric.f));
            append(points, static_cast<float>((y - camera.cy) * z / camera.metric.f));
            append(points, static_cast<float>(z));
            const Colour colour = colour_at(left, x, y);
            if (format == "ply") {
                append(points, colour);
            } else {
                append(points, std::uint32_t{colour.red} << 16U | std::uint32_t{colour.green} << 8U | colour.blue);
            }
        }
    }
    return head(format, count) + points;
}

}  // namespace disparityd::images
