// SPDX-License-Identifier: Apache-2.0
//
// make_recording LEFT.png RIGHT.png CALIBRATION OUT.mkv FRAMES: a recording as a ZED would give it, from two raw
// pictures: side by side as YUYV, with the calibration inside. Each frame is the picture moved one row down, so that
// frames differ.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "capture/recording/recording_writer.h"

namespace {

using namespace disparityd;

std::uint8_t to_byte(int value) {
    return static_cast<std::uint8_t>(std::clamp(value, 0, 255));
}

// BT.601 in integers; chroma of the even pixel for the pair.
void put_row(const cv::Vec3b* bgr, int width, std::uint8_t* yuyv) {
    for (int x = 0; x < width; ++x) {
        const int b = bgr[x][0];
        const int g = bgr[x][1];
        const int r = bgr[x][2];
        yuyv[2 * x] = to_byte((66 * r + 129 * g + 25 * b + 128) / 256 + 16);
        if (x % 2 == 0) {
            yuyv[2 * x + 1] = to_byte((-38 * r - 74 * g + 112 * b) / 256 + 128);
            yuyv[2 * x + 3] = to_byte((112 * r - 94 * g - 18 * b) / 256 + 128);
        }
    }
}

std::vector<std::uint8_t> side_by_side(const cv::Mat& left, const cv::Mat& right, int shift) {
    const auto stride = static_cast<std::size_t>(4 * left.cols);
    std::vector<std::uint8_t> pixels(stride * static_cast<std::size_t>(left.rows));
    for (int y = 0; y < left.rows; ++y) {
        std::uint8_t* row = pixels.data() + stride * static_cast<std::size_t>(y);
        const int from = (y + left.rows - shift) % left.rows;
        put_row(left.ptr<cv::Vec3b>(from), left.cols, row);
        put_row(right.ptr<cv::Vec3b>(from), right.cols, row + stride / 2);
    }
    return pixels;
}

void record(const char* left_path, const char* right_path, const char* calibration, const char* out, int frames) {
    const cv::Mat left = cv::imread(left_path, cv::IMREAD_COLOR);
    const cv::Mat right = cv::imread(right_path, cv::IMREAD_COLOR);
    capture::SourceInfo info;
    info.name = "zed";
    info.format = PixelFormat::yuyv;
    info.eye_width = left.cols;
    info.height = left.rows;
    info.rate = 15;
    info.calibration = calibration::read_calibration(calibration, left.cols, left.rows);
    capture::RecordingWriter writer(out, info);
    for (int i = 0; i < frames; ++i) {
        const std::vector<std::uint8_t> pixels = side_by_side(left, right, i);
        capture::RawFrame frame;
        frame.image = {pixels.data(), PixelFormat::yuyv, left.cols, left.rows, 4 * left.cols};
        frame.sequence = 100 + static_cast<std::uint64_t>(i);
        frame.monotonic_ns = 1'000'000'007 + i * std::int64_t{66'666'667};
        frame.realtime_ns = 1'700'000'000'000'000'003 + i * std::int64_t{66'666'667};
        writer.write(frame);
    }
    writer.close();
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 6) {
        std::fputs("usage: make_recording LEFT RIGHT CALIBRATION OUT FRAMES\n", stderr);
        return 2;
    }
    try {
        record(argv[1], argv[2], argv[3], argv[4], std::atoi(argv[5]));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "make_recording: error: %s\n", error.what());
        return 1;
    }
    return 0;
}
