// SPDX-License-Identifier: Apache-2.0
//
// A camera that sends JPEGs, whole and damaged, as the kernel hands them on.
#include <algorithm>
#include <fstream>
#include <memory>

#include <gtest/gtest.h>
#include <turbojpeg.h>

#include "tests/capture/camera/made_jpeg.h"
#include "tests/vm/guest/camera_process.h"
#include "tests/vm/guest/live_daemon.h"

namespace vm_guest {
namespace {

using disparityd::capture::test::Bytes;
using Status = LiveDaemon::Status;

constexpr int frame_width = 1344;
constexpr int frame_height = 376;

class LiveJpeg : public testing::Test {
protected:
    LiveJpeg() {
        const Bytes jpeg = disparityd::capture::test::made_jpeg(frame_width, frame_height, TJSAMP_422, 1);
        luma_ = disparityd::capture::test::planes_of(jpeg, frame_width, frame_height).luma;
        std::ofstream("/run/both.jpg", std::ios::binary)
            .write(reinterpret_cast<const char*>(jpeg.data()), static_cast<std::streamsize>(jpeg.size()));
        camera_ = std::make_unique<CameraProcess>(std::vector<std::string>{"--jpeg", "/run/both.jpg"});
        daemon_ = std::make_unique<LiveDaemon>("v4l2:vga@15?format=mjpeg", "/vm/disparityd",
                                               std::vector<std::string>{"source.stall_ms=15000"});
    }

    /// Frames come, and the one that came last has the pixels of the JPEG.
    bool streams() {
        if (!daemon_->wait_for_camera("streaming") || !daemon_->wait_for_new_frame()) {
            return false;
        }
        const disparity::PlaneData left = *daemon_->frame().plane(disparity::Product::left);
        const auto* pixels = reinterpret_cast<const std::uint8_t*>(left.bytes.data());
        for (std::size_t y = 0; y < frame_height; ++y) {
            const std::uint8_t* row = pixels + y * (frame_width / 2);
            if (!std::equal(row, row + frame_width / 2, luma_.data() + y * frame_width)) {
                return false;
            }
        }
        return true;
    }

    Bytes luma_;
    std::unique_ptr<CameraProcess> camera_;
    std::unique_ptr<LiveDaemon> daemon_;
};

TEST_F(LiveJpeg, DamageIsCountedAndTheCameraComesBackFromAnUnplugging) {
    ASSERT_TRUE(streams()) << daemon_->log();
    const std::uint64_t damaged = daemon_->status().camera().damaged();
    // A busy daemon drops frames before it decodes them.
    EXPECT_TRUE(daemon_->wait_for([&](const Status& status) {
        if (status.camera().damaged() == damaged) {
            camera_->tell("short 1");
        }
        return status.camera().damaged() > damaged;
    })) << in_words(daemon_->status());
    EXPECT_TRUE(streams());
    camera_->unplug();
    EXPECT_TRUE(daemon_->wait_for_camera("absent"));
    camera_->plug();
    EXPECT_TRUE(streams()) << daemon_->log();
}

}  // namespace
}  // namespace vm_guest
