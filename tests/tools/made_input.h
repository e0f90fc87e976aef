// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace disparityd::test {

/// A test with a folder of its own, removed afterwards.
class FolderTest : public testing::Test {
protected:
    void SetUp() override;
    void TearDown() override;
    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    std::filesystem::path folder_;
};

/// A rectified pair of random texture: right (x - shift) shows what left (x) shows.
struct Pair {
    cv::Mat left;
    cv::Mat right;
};
Pair shifted_pair(int width, int height, int shift, unsigned seed);

/// Grey pairs in KITTI's layout (image_0, image_1), frame i shifted by 3 + i % 8 px.
void make_kitti_folder(const std::string& folder, int frames, int width, int height);

/// The same pairs as a recording, grey, without calibration.
void make_recording(const std::string& path, int frames, int width, int height);

/// Name to bytes of every file in a folder, but for times.csv.
std::map<std::string, std::string> files_in(const std::string& folder);

std::string read_file(const std::string& path);
void write_text(const std::string& path, const std::string& text);

}  // namespace disparityd::test
