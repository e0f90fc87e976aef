// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <fstream>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "capture/frame_source.h"

namespace disparityd::capture::test {

/// An image whose bytes tell what and where they are.
inline cv::Mat numbered_image(int width, int height, int type, int number) {
    cv::Mat image(height, width, type);
    for (int y = 0; y < height; ++y) {
        auto* row = image.ptr<std::uint8_t>(y);
        for (int x = 0; x < width * image.channels(); ++x) {
            row[x] = static_cast<std::uint8_t>(31 * number + 3 * x + 7 * y);
        }
    }
    return image;
}

inline void write_image(const std::string& path, const cv::Mat& image) {
    ASSERT_TRUE(cv::imwrite(path, image)) << path;
}

inline void write_file(const std::string& path, const std::string& text) {
    std::ofstream file(path, std::ios::binary);
    file << text;
    ASSERT_TRUE(file.flush()) << path;
}

inline std::chrono::steady_clock::time_point soon() {
    return std::chrono::steady_clock::now() + std::chrono::seconds(20);
}

/// The text of what a call throws as an error of the user's; anything else fails the test.
template <typename Call>
std::string refusal(Call call) {
    try {
        call();
    } catch (const std::invalid_argument& problem) {
        const std::string text = problem.what();
        EXPECT_EQ(text.find('\n'), std::string::npos) << text;
        return text;
    }
    ADD_FAILURE() << "nothing was refused";
    return {};
}

}  // namespace disparityd::capture::test
