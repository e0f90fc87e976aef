// SPDX-License-Identifier: Apache-2.0
#include "tests/tools/made_input.h"

#include <cstdio>
#include <fstream>
#include <iterator>
#include <random>

#include <opencv2/imgproc.hpp>

#include "capture/recording/recording_writer.h"
#include "tools/images/image_file.h"

namespace disparityd::test {

namespace fs = std::filesystem;

void FolderTest::SetUp() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(testing::TempDir()) / (std::string(info->test_suite_name()) + '.' + info->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
}

void FolderTest::TearDown() {
    fs::remove_all(folder_);
}

Pair shifted_pair(int width, int height, int shift, unsigned seed) {
    std::mt19937 random(seed);
    cv::Mat texture(height, width + shift, CV_8UC1);
    for (auto value = texture.begin<std::uint8_t>(); value != texture.end<std::uint8_t>(); ++value) {
        *value = static_cast<std::uint8_t>(random() >> 24);
    }
    return {texture.colRange(0, width).clone(), texture.colRange(shift, width + shift).clone()};
}

void make_kitti_folder(const std::string& folder, int frames, int width, int height) {
    fs::create_directories(folder + "/image_0");
    fs::create_directories(folder + "/image_1");
    for (int i = 0; i < frames; ++i) {
        const Pair pair = shifted_pair(width, height, 3 + i % 8, static_cast<unsigned>(i));
        char name[32];
        std::snprintf(name, sizeof name, "/%06d.png", i);
        images::write_png(folder + "/image_0" + name, pair.left);
        images::write_png(folder + "/image_1" + name, pair.right);
    }
}

void make_recording(const std::string& path, int frames, int width, int height) {
    capture::SourceInfo info;
    info.name = "made";
    info.description = "made by a test";
    info.format = PixelFormat::grey8;
    info.eye_width = width;
    info.height = height;
    info.rate = 15;
    capture::RecordingWriter writer(path, info);
    for (int i = 0; i < frames; ++i) {
        const Pair pair = shifted_pair(width, height, 3 + i % 8, static_cast<unsigned>(i));
        cv::Mat both;
        cv::hconcat(pair.left, pair.right, both);
        capture::RawFrame frame;
        frame.image = {both.data, PixelFormat::grey8, width, height, static_cast<std::ptrdiff_t>(both.step[0])};
        frame.sequence = static_cast<std::uint64_t>(i);
        frame.monotonic_ns = 1'000'000'000 + i * 66'666'667LL;
        frame.realtime_ns = 1'700'000'000'000'000'000 + frame.monotonic_ns;
        writer.write(frame);
    }
    writer.close();
}

std::map<std::string, std::string> files_in(const std::string& folder) {
    std::map<std::string, std::string> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        if (entry.path().filename() != "times.csv") {
            files[entry.path().filename().string()] = read_file(entry.path().string());
        }
    }
    return files;
}

std::string read_file(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

void write_text(const std::string& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
}

}  // namespace disparityd::test
