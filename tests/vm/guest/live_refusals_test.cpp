// SPDX-License-Identifier: Apache-2.0
//
// A daemon that starts before its camera can be used: each reason is said to a connected client, and gone when it is
// gone.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/vm/guest/camera_process.h"
#include "tests/vm/guest/live_daemon.h"
#include "tests/vm/guest/video_reader.h"

namespace vm_guest {
namespace {

using Status = LiveDaemon::Status;

void expect_said(LiveDaemon& daemon, const std::string& state, const std::string& advice) {
    EXPECT_TRUE(daemon.wait_for([&](const Status& status) {
        return status.camera().state() == state && status.detail().find(advice) != std::string::npos;
    })) << state
        << ", " << advice << "; now: " << in_words(daemon.status()) << "\n"
        << daemon.log();
}

void open_to_all(const CameraProcess& camera) {
    ASSERT_EQ(::chmod(camera.node().path.c_str(), 0666), 0);
}

TEST(LiveRefusals, AreSaidWithWhatToDo) {
    LiveDaemon daemon("v4l2:hd720@15", "/vm/vm_run_as_nobody", {"rectify.width=160", "rectify.height=90"});
    expect_said(daemon, "absent", "plug it in");
    {
        CameraProcess camera({"--usb2"});
        open_to_all(camera);
        expect_said(daemon, "usb2-link", "USB 3");
    }
    CameraProcess camera;
    expect_said(daemon, "no-permission", "group video");
    {
        VideoReader other(camera.node().path, {1344, 376});
        other.start();
        open_to_all(camera);
        expect_said(daemon, "busy", "another program");
    }
    EXPECT_TRUE(daemon.wait_for_camera("streaming"));
    EXPECT_TRUE(daemon.wait_for_new_frame());
    camera.unplug();
    camera.plug("zed-old 12345");
    expect_said(daemon, "old-firmware", "update");
    camera.unplug();
    camera.plug("zed 12345");
    open_to_all(camera);
    EXPECT_TRUE(daemon.wait_for_camera("streaming"));
    EXPECT_TRUE(daemon.wait_for_new_frame());
}

TEST(LiveSelection, TheCameraWithTheSerialNumberIsUsedAndNoOther) {
    const CameraProcess one({"--serial", "11111"});
    const CameraProcess two({"--serial", "22222"});
    LiveDaemon daemon("v4l2:vga@15?serial=22222");
    EXPECT_TRUE(daemon.wait_for_camera("streaming")) << daemon.log();
    EXPECT_TRUE(daemon.wait_for_new_frame());
    EXPECT_EQ(daemon.status().camera().serial(), "22222");
    EXPECT_EQ(daemon.status().camera().node(), two.node().path);
    EXPECT_EQ(one.counter("streaming"), 0);
    EXPECT_EQ(two.counter("streaming"), 1);
}

}  // namespace
}  // namespace vm_guest
