// SPDX-License-Identifier: Apache-2.0
//
// The kernel's own test driver for V4L2, beside the simulated camera: a camera that is no USB device and takes any
// size.
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include "tests/vm/camera/camera_model.h"
#include "tests/vm/guest/video_reader.h"
#include "tests/vm/guest/vivid_device.h"

namespace vm_guest {
namespace {

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
    set_vivid("Inject V4L2_BUF_FLAG_ERROR");
    for (int i = 0; i < 20 && (frame.flags & V4L2_BUF_FLAG_ERROR) == 0; ++i) {
        ASSERT_TRUE(reader.read(frame));
    }
    EXPECT_NE(frame.flags & V4L2_BUF_FLAG_ERROR, 0U);
}

}  // namespace
}  // namespace vm_guest
