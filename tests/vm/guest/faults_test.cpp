// SPDX-License-Identifier: Apache-2.0
//
// Each fault of the simulated camera, as it shows to a user of V4L2: that the faults are what they claim to be, before
// the daemon is tested against them.
#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/usbdevice_fs.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>

#include "tests/vm/camera/test_pattern.h"
#include "tests/vm/guest/camera_process.h"
#include "tests/vm/guest/video_reader.h"

namespace vm_guest {
namespace {

using simulated_camera::first_difference_from_pattern;
using simulated_camera::pattern_number;

constexpr milliseconds a_while{1000};

class Faults : public testing::Test {
protected:
    void start() {
        reader_.start();
        expect_whole_frame();
    }

    void expect_whole_frame() {
        VideoReader::Frame frame;
        ASSERT_TRUE(reader_.read(frame));
        EXPECT_EQ(frame.flags & V4L2_BUF_FLAG_ERROR, 0U);
        ASSERT_EQ(frame.bytes.size(), 2U * vga.width * vga.height);
        EXPECT_EQ(first_difference_from_pattern(frame.bytes), -1);
        last_ = std::move(frame);
    }

    // Frames are whole, and sooner or later one follows another with a sequence number missing between them.
    void expect_gap_in_sequence() {
        for (int i = 0; i < 100; ++i) {
            const std::uint32_t before = last_.sequence;
            ASSERT_NO_FATAL_FAILURE(expect_whole_frame());
            if (last_.sequence != before + 1) {
                return;
            }
        }
        FAIL() << "no gap";
    }

    bool silent() {
        VideoReader::Frame frame;
        while (reader_.read(frame, a_while)) {
            // What was under way when the fault came.
            if (++buffers_before_silence_ > 20) {
                return false;
            }
        }
        return true;
    }

    CameraProcess camera_;
    VideoReader reader_{camera_.node().path, vga};
    VideoReader::Frame last_;
    int buffers_before_silence_ = 0;
};

TEST_F(Faults, AFrameWithErrorIsOnlyAGap) {
    start();
    camera_.tell("err 1");
    expect_gap_in_sequence();
}

TEST_F(Faults, AShortFrameIsOnlyAGap) {
    start();
    camera_.tell("short 2");
    expect_gap_in_sequence();
}

TEST_F(Faults, FramesThatTheCameraDropsShowInTheirNumbersOnly) {
    start();
    camera_.tell("drop 30");
    for (int i = 0; i < 20; ++i) {
        const VideoReader::Frame before = last_;
        expect_whole_frame();
        EXPECT_EQ(last_.sequence, before.sequence + 1);
        if (pattern_number(last_.bytes) > pattern_number(before.bytes) + 30) {
            return;
        }
    }
    FAIL() << "no frame is missing";
}

TEST_F(Faults, AStallGivesBuffersBackWithTheErrorFlag) {
    start();
    camera_.tell("stall 1");
    VideoReader::Frame frame;
    for (int i = 0; i < 50; ++i) {
        ASSERT_TRUE(reader_.read(frame));
        if ((frame.flags & V4L2_BUF_FLAG_ERROR) != 0) {
            EXPECT_EQ(frame.bytes.size(), 0U);
            return;
        }
    }
    FAIL() << "no buffer with the error flag";
}

TEST_F(Faults, StallsOfAllTransfersLastUntilTheStreamStartsAgain) {
    start();
    camera_.tell("stall 5");
    EXPECT_TRUE(silent());
    camera_.tell("stall 0");
    EXPECT_TRUE(silent());
    reader_.stop();
    start();
}

TEST_F(Faults, AFreezeLastsUntilTheThaw) {
    start();
    camera_.tell("freeze");
    EXPECT_TRUE(silent());
    camera_.tell("thaw");
    expect_whole_frame();
}

TEST_F(Faults, AFreezeThatAStreamRestartEnds) {
    start();
    camera_.tell("freeze restart");
    EXPECT_TRUE(silent());
    reader_.stop();
    start();
}

TEST_F(Faults, AFreezeThatOnlyAResetEnds) {
    start();
    camera_.tell("freeze reset");
    EXPECT_TRUE(silent());
    reader_.stop();
    reader_.start();
    EXPECT_TRUE(silent());
    const simulated_camera::FileDescriptor device(::open(usb_node(camera_.node()).c_str(), O_RDWR | O_CLOEXEC));
    ASSERT_TRUE(device);
    // Wakes the driver up, which loses the device and finds it again.
    EXPECT_EQ(::ioctl(device.get(), USBDEVFS_RESET), 0) << std::system_category().message(errno);
    ASSERT_TRUE(eventually([&] {
        const auto nodes = usb_video_nodes();
        return !nodes.empty() && nodes[0].path != camera_.node().path;
    }));
    VideoReader again(usb_video_nodes()[0].path, vga);
    again.start();
    VideoReader::Frame frame;
    ASSERT_TRUE(again.read(frame));
    EXPECT_EQ(first_difference_from_pattern(frame.bytes), -1);
}

TEST_F(Faults, UnplugEndsTheStreamAndTheNodeComesBackUnderAnotherNumberWhileItIsHeld) {
    start();
    const std::string before = camera_.node().path;
    camera_.unplug();
    EXPECT_THROW(
        {
            VideoReader::Frame frame;
            while (reader_.read(frame)) {
            }
        },
        std::system_error);
    camera_.plug();
    EXPECT_NE(camera_.node().path, before);
    VideoReader again(camera_.node().path, vga);
    again.start();
    VideoReader::Frame frame;
    ASSERT_TRUE(again.read(frame));
    EXPECT_EQ(first_difference_from_pattern(frame.bytes), -1);
}

TEST_F(Faults, ASecondUserMayOpenTheNodeButNotUseIt) {
    start();
    const simulated_camera::FileDescriptor opened(::open(camera_.node().path.c_str(), O_RDWR | O_CLOEXEC));
    EXPECT_TRUE(opened);
    try {
        VideoReader second(camera_.node().path, vga);
        second.start();
        FAIL() << "two streams of one camera";
    } catch (const std::system_error& error) {
        EXPECT_EQ(error.code().value(), EBUSY);
    }
}

TEST(Replug, TenTimes) {
    CameraProcess camera;
    for (int i = 0; i < 10; ++i) {
        camera.unplug();
        camera.plug(i % 2 == 0 ? "zed2 222" : "zed 111");
        ASSERT_EQ(camera.node().product_id, i % 2 == 0 ? 0xf780 : 0xf582);
    }
    VideoReader reader(camera.node().path, vga);
    reader.start();
    VideoReader::Frame frame;
    ASSERT_TRUE(reader.read(frame));
    EXPECT_EQ(first_difference_from_pattern(frame.bytes), -1);
}

}  // namespace
}  // namespace vm_guest
