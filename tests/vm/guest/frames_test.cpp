// SPDX-License-Identifier: Apache-2.0
//
// Every byte that the camera sends arrives, by every way that USB has, in every mode.
#include <fstream>

#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include "tests/vm/camera/camera_model.h"
#include "tests/vm/camera/test_pattern.h"
#include "tests/vm/guest/camera_process.h"
#include "tests/vm/guest/video_reader.h"

namespace vm_guest {
namespace {

using simulated_camera::first_difference_from_pattern;
using simulated_camera::pattern_number;

void expect_pattern(VideoReader& reader, std::size_t frame_bytes, int frames) {
    reader.start();
    std::uint32_t last_number = 0;
    std::uint32_t last_sequence = 0;
    for (int i = 0; i < frames; ++i) {
        VideoReader::Frame frame;
        ASSERT_TRUE(reader.read(frame)) << "frame " << i;
        EXPECT_EQ(frame.flags & V4L2_BUF_FLAG_ERROR, 0U);
        EXPECT_EQ(frame.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK, V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC);
        ASSERT_EQ(frame.bytes.size(), frame_bytes);
        EXPECT_EQ(first_difference_from_pattern(frame.bytes), -1) << "frame " << i;
        if (i > 0) {
            EXPECT_GT(pattern_number(frame.bytes), last_number);
            EXPECT_EQ(frame.sequence, last_sequence + 1);
        }
        last_number = pattern_number(frame.bytes);
        last_sequence = frame.sequence;
    }
    reader.stop();
}

TEST(Frames, EveryModeIsWholeToTheByte) {
    const CameraProcess camera;
    for (const auto& mode : simulated_camera::modes) {
        SCOPED_TRACE(testing::Message() << mode.width << "x" << mode.height);
        VideoReader reader(camera.node().path, {mode.width, mode.height});
        EXPECT_EQ(reader.sizes().size(), simulated_camera::modes.size());
        expect_pattern(reader, mode.frame_bytes(), 3);
    }
}

class Ways : public testing::TestWithParam<std::vector<std::string>> {};

TEST_P(Ways, AllGiveTheSameBytes) {
    const CameraProcess camera(GetParam());
    VideoReader reader(camera.node().path, vga);
    expect_pattern(reader, 2U * vga.width * vga.height, 5);
}

INSTANTIATE_TEST_SUITE_P(Frames, Ways,
                         testing::Values(std::vector<std::string>{"--usb2"}, std::vector<std::string>{"--isochronous"},
                                         std::vector<std::string>{"--isochronous", "--usb2"}));

TEST(Frames, OnlyTheSmallestModeOnUsb2AndWithOldFirmware) {
    for (const std::vector<std::string>& options : {std::vector<std::string>{"--usb2"}, {"--model", "zed-old"}}) {
        const CameraProcess camera(options);
        const VideoReader reader(camera.node().path, vga);
        EXPECT_EQ(reader.sizes().size(), 1U) << options.back();
    }
}

TEST(Frames, AFileComesOutAsItIs) {
    std::vector<std::uint8_t> bytes(2U * 2 * vga.width * vga.height);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        bytes[i] = static_cast<std::uint8_t>(i * i >> 7);
    }
    const std::string file = "/tmp/frames.yuyv";
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    const CameraProcess camera({"--frames", file});
    VideoReader reader(camera.node().path, vga);
    reader.start();
    const std::vector<std::uint8_t> first(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2));
    const std::vector<std::uint8_t> second(bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2), bytes.end());
    for (int i = 0; i < 4; ++i) {
        VideoReader::Frame frame;
        ASSERT_TRUE(reader.read(frame));
        EXPECT_TRUE(frame.bytes == first || frame.bytes == second);
    }
}

TEST(Frames, TwoCamerasAtOnce) {
    const CameraProcess one({"--serial", "111"});
    const CameraProcess two({"--serial", "222", "--model", "zed2i"});
    EXPECT_EQ(one.node().product_id, 0xf582);
    EXPECT_EQ(two.node().product_id, 0xf880);
    VideoReader first(one.node().path, vga);
    VideoReader second(two.node().path, vga);
    first.start();
    second.start();
    for (int i = 0; i < 3; ++i) {
        for (VideoReader* reader : {&first, &second}) {
            VideoReader::Frame frame;
            ASSERT_TRUE(reader->read(frame));
            EXPECT_EQ(first_difference_from_pattern(frame.bytes), -1);
        }
    }
}

}  // namespace
}  // namespace vm_guest
