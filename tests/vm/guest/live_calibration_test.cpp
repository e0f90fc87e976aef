// SPDX-License-Identifier: Apache-2.0
//
// Each camera gets the calibration that belongs to its serial number, and none is used without one.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/vm/guest/camera_process.h"
#include "tests/vm/guest/live_daemon.h"

namespace vm_guest {
namespace {

using Status = LiveDaemon::Status;

void write_calibration(const disparityd::test::TemporaryFolder& folder, const std::string& serial,
                       const std::string& baseline) {
    const std::string eye = "fx=350\nfy=350\ncx=336\ncy=188\nk1=-0.17\nk2=0.02\n";
    folder.write("SN" + serial + ".conf", "[LEFT_CAM_VGA]\n" + eye + "[RIGHT_CAM_VGA]\n" + eye + "[STEREO]\nBaseline=" +
                                              baseline + "\nTY=0.1\nTZ=0.2\nCV_VGA=0.01\nRX_VGA=0.001\nRZ_VGA=0.002\n");
}

TEST(LiveCalibration, FollowsTheSerialNumberOfWhateverCameraIsThere) {
    const disparityd::test::TemporaryFolder folder;
    write_calibration(folder, "11111", "120");
    write_calibration(folder, "22222", "63");
    CameraProcess camera({"--serial", "11111"});
    LiveDaemon daemon("v4l2:vga@15", "/vm/disparityd",
                      {"source.calibration_folders=" + folder.path(), "source.allow_unrectified=false",
                       "source.stall_ms=15000", "rectify.width=160", "rectify.height=90"});
    // The one client of `daemon` sees all of it.
    const auto frames_of = [&](double baseline) {
        return eventually([&] {
            return daemon.wait_for_new_frame() && std::abs(daemon.frame().baseline_mm - baseline) < 1 &&
                   (daemon.frame().flags & disparity::unrectified) == 0;
        });
    };
    EXPECT_TRUE(frames_of(120)) << daemon.log();

    camera.unplug();
    camera.plug("mini 22222");
    EXPECT_TRUE(frames_of(63)) << daemon.log();

    camera.unplug();
    camera.plug("zed2 33333");
    EXPECT_TRUE(daemon.wait_for([&](const Status& status) {
        return status.state() == "waiting" && status.camera().state() == "no-calibration" &&
               status.detail().find("put SN33333.conf into " + folder.path()) != std::string::npos;
    })) << in_words(daemon.status())
        << "\n"
        << daemon.log();
    write_calibration(folder, "33333", "119");
    EXPECT_TRUE(frames_of(119)) << daemon.log();
    EXPECT_EQ(daemon.status().camera().serial(), "33333");
}

}  // namespace
}  // namespace vm_guest
