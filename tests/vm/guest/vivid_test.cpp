// SPDX-License-Identifier: Apache-2.0
//
// The kernel's own test driver for V4L2, beside the simulated camera: a camera that is no USB device and takes any
// size.
#include <filesystem>
#include <stdexcept>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>

#include "tests/vm/camera/camera_model.h"
#include "tests/vm/guest/video_nodes.h"
#include "tests/vm/guest/video_reader.h"

namespace vm_guest {
namespace {

std::string vivid_node() {
    for (const auto& entry : std::filesystem::directory_iterator("/sys/class/video4linux")) {
        if (first_line(entry.path() / "name").starts_with("vivid")) {
            return "/dev/" + entry.path().filename().string();
        }
    }
    throw std::runtime_error("no vivid node");
}

void press(const VideoReader& reader, const std::string& control_name) {
    v4l2_queryctrl control{};
    control.id = V4L2_CTRL_FLAG_NEXT_CTRL;
    while (::ioctl(reader.descriptor(), VIDIOC_QUERYCTRL, &control) == 0) {
        if (reinterpret_cast<const char*>(control.name) == control_name) {
            v4l2_control pressed{control.id, 1};
            EXPECT_EQ(::ioctl(reader.descriptor(), VIDIOC_S_CTRL, &pressed), 0);
            return;
        }
        control.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
    }
    FAIL() << "vivid has no control " << control_name;
}

TEST(Vivid, GivesEveryModeOfTheCamera) {
    for (const auto& mode : simulated_camera::modes) {
        VideoReader reader(vivid_node(), {mode.width, mode.height});
        reader.start();
        VideoReader::Frame frame;
        ASSERT_TRUE(reader.read(frame));
        EXPECT_EQ(frame.bytes.size(), mode.frame_bytes());
        reader.stop();
    }
}

TEST(Vivid, FlagsAFrameOnDemand) {
    VideoReader reader(vivid_node(), {1344, 376});
    reader.start();
    VideoReader::Frame frame;
    ASSERT_TRUE(reader.read(frame));
    EXPECT_EQ(frame.flags & V4L2_BUF_FLAG_ERROR, 0U);
    press(reader, "Inject V4L2_BUF_FLAG_ERROR");
    for (int i = 0; i < 20 && (frame.flags & V4L2_BUF_FLAG_ERROR) == 0; ++i) {
        ASSERT_TRUE(reader.read(frame));
    }
    EXPECT_NE(frame.flags & V4L2_BUF_FLAG_ERROR, 0U);
}

}  // namespace
}  // namespace vm_guest
