// SPDX-License-Identifier: Apache-2.0
//
// What `process` writes beside disparities, as OpenCV and a reader of this test see it.
#include <bit>
#include <cmath>
#include <cstring>
#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/tools/made_input.h"
#include "tests/tools/run_program.h"

namespace disparityd::test {
namespace {

using testing::HasSubstr;

class ProcessOutputsTest : public FolderTest {
protected:
    Outcome process(const std::string& source, const std::string& folder, std::vector<std::string> more) const {
        more.insert(more.begin(), {"process", source, "-o", path(folder), "--disparities", "64"});
        return run(DISPARITYCTL, more);
    }

    cv::Mat image(const std::string& name) const { return cv::imread(path(name), cv::IMREAD_UNCHANGED); }

    nlohmann::json rectified(const std::string& folder) const {
        return nlohmann::json::parse(read_file(path(folder + "/geometry.json"))).at("rectified");
    }
};

const std::string scene = "scene:vga?width=96&height=64&frames=2";

/// A header up to its last line, and what lies behind it.
struct PointFile {
    std::string head;
    std::string points;

    explicit PointFile(const std::string& bytes, const std::string& last) {
        const std::size_t end = bytes.find(last) + last.size();
        head = bytes.substr(0, end);
        points = bytes.substr(end);
    }

    template <typename T>
    T at(std::size_t offset) const {
        T value;
        std::memcpy(&value, points.data() + offset, sizeof(T));
        return value;
    }
};

TEST_F(ProcessOutputsTest, EachIsWhatOtherReadersExpect) {
    const std::vector<std::string> all{"--pfm",    "--depth", "--depth-error", "--confidence", "--rectified",
                                       "--points", "ply"};
    ASSERT_EQ(process(scene, "out", all).exit_code, 0);
    ASSERT_EQ(process(scene, "pcd", {"--points", "pcd"}).exit_code, 0);
    const auto camera = rectified("out");
    const double f = camera["f"], baseline_m = camera["baseline_mm"].get<double>() / 1000;
    const double cx = camera["cx"], cy = camera["cy"];
    ASSERT_EQ(camera["disparity_offset"], 0);
    const cv::Mat kitti = image("out/000001.png"), middlebury = image("out/000001.pfm");
    const cv::Mat depth = image("out/000001_depth.png"), error = image("out/000001_depth_error.png");
    const cv::Mat confidence = image("out/000001_confidence.png"), left = image("out/000001_left.png");
    ASSERT_EQ(kitti.type(), CV_16UC1);
    ASSERT_EQ(middlebury.type(), CV_32FC1);
    ASSERT_EQ(depth.type(), CV_16UC1);
    ASSERT_EQ(left.type(), CV_8UC3);
    ASSERT_EQ(image("out/000001_right.png").size(), left.size());
    EXPECT_EQ(read_file(path("out/000001.pfm")).substr(0, 14), "Pf\n96 64\n-1.0\n") << "little endian";
    const PointFile ply(read_file(path("out/000001.ply")), "end_header\n");
    const PointFile pcd(read_file(path("pcd/000001.pcd")), "DATA binary\n");
    std::size_t points = 0;
    for (int y = 0; y < kitti.rows; ++y) {
        for (int x = 0; x < kitti.cols; ++x) {
            const double d = middlebury.at<float>(y, x);
            if (std::isinf(d)) {
                EXPECT_EQ(kitti.at<std::uint16_t>(y, x), 0);
                EXPECT_EQ(depth.at<std::uint16_t>(y, x) + error.at<std::uint16_t>(y, x), 0);
                EXPECT_EQ(confidence.at<std::uint8_t>(y, x), 0);
                continue;
            }
            ASSERT_EQ(kitti.at<std::uint16_t>(y, x), std::max(1.0, d * 256));
            if (d == 0) {  // at infinity
                EXPECT_EQ(depth.at<std::uint16_t>(y, x), 65535);
                continue;
            }
            EXPECT_GT(confidence.at<std::uint8_t>(y, x), 0);
            const double z = f * baseline_m / d, sigma = z * 0.25 / d;
            if (z < 60) {
                EXPECT_NEAR(depth.at<std::uint16_t>(y, x), z * 1000, 1);
                EXPECT_NEAR(error.at<std::uint16_t>(y, x), std::min(sigma * 1000, 65535.0), 1 + sigma * 10);
            }
            const double expected[] = {(x - cx) * z / f, (y - cy) * z / f, z};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const auto of_ply = ply.at<float>(points * 15 + axis * 4);
                ASSERT_NEAR(of_ply, expected[axis], 1e-5 * z);
                ASSERT_EQ(pcd.at<float>(points * 16 + axis * 4), of_ply);
            }
            const auto& bgr = left.at<cv::Vec3b>(y, x);
            for (std::size_t channel = 0; channel < 3; ++channel) {
                ASSERT_EQ(ply.at<std::uint8_t>(points * 15 + 12 + channel), bgr[static_cast<int>(2 - channel)]);
            }
            ASSERT_EQ(pcd.at<std::uint32_t>(points * 16 + 12),
                      std::uint32_t{bgr[2]} << 16U | std::uint32_t{bgr[1]} << 8U | bgr[0]);
            ++points;
        }
    }
    EXPECT_GT(points, 1000U);
    EXPECT_EQ(ply.points.size(), points * 15);
    EXPECT_EQ(pcd.points.size(), points * 16);
    EXPECT_THAT(ply.head, HasSubstr("format binary_little_endian 1.0\n"));
    EXPECT_THAT(ply.head, HasSubstr("element vertex " + std::to_string(points) + '\n'));
    EXPECT_THAT(pcd.head, HasSubstr("\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\n"));
    EXPECT_THAT(pcd.head, HasSubstr("\nPOINTS " + std::to_string(points) + '\n'));
    EXPECT_EQ(run(DISPARITYCTL, {"verify", path("out")}).exit_code, 0);

    // A later run takes all of them away.
    ASSERT_EQ(process(scene, "out", {"--force"}).exit_code, 0);
    EXPECT_EQ(files_in(path("out")).size(), 4U);
}

TEST_F(ProcessOutputsTest, TheRectifiedPairIsOneOfMiddlebury) {
    ASSERT_EQ(process(scene, "out", {"--rectified"}).exit_code, 0);
    std::filesystem::create_directories(path("pair"));
    std::filesystem::copy_file(path("out/000000_left.png"), path("pair/im0.png"));
    std::filesystem::copy_file(path("out/000000_right.png"), path("pair/im1.png"));
    std::filesystem::copy_file(path("out/calib.txt"), path("pair/calib.txt"));
    const Outcome again = process(path("pair"), "again", {});
    ASSERT_EQ(again.exit_code, 0) << again.err;
    const auto one = rectified("out"), two = rectified("again");
    for (const char* const number : {"f", "cx", "cy", "baseline_mm", "disparity_offset", "width", "height"}) {
        EXPECT_DOUBLE_EQ(one[number].get<double>(), two[number].get<double>()) << number;
    }
}

TEST_F(ProcessOutputsTest, WhatIsNotKnownIsRefused) {
    make_recording(path("walk.mkv"), 1, 64, 32);
    for (const std::string option : {"--depth", "--depth-error"}) {
        const Outcome outcome = process(path("walk.mkv"), "none", {option});
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_THAT(outcome.err, HasSubstr(option + ": " + path("walk.mkv") + " has no calibration"));
    }
    EXPECT_THAT(process(path("walk.mkv"), "none", {"--points", "pcd"}).err, HasSubstr("--points: "));
    EXPECT_EQ(process(scene, "none", {"--points", "xyz"}).exit_code, 2);
    EXPECT_FALSE(std::filesystem::exists(path("none")));
    ASSERT_EQ(process(path("walk.mkv"), "grey", {"--rectified"}).exit_code, 0);
    EXPECT_EQ(image("grey/000000_left.png").type(), CV_8UC1);
    EXPECT_FALSE(std::filesystem::exists(path("grey/calib.txt"))) << "nothing is known";
}

}  // namespace
}  // namespace disparityd::test
