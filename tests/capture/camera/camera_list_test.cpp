// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "capture/camera/camera_problem.h"
#include "capture/camera/camera_uri.h"

namespace disparityd::capture {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// A sysfs tree as the kernel has it for two cameras and one that is no USB device.
class CameraListTest : public ::testing::Test {
protected:
    CameraListTest() : root_(fs::temp_directory_path() / ("cameras-" + std::to_string(getpid()))) {
        fs::remove_all(root_);
        fs::create_directories(root_ / "class/video4linux");
        fs::create_directories(root_ / "bus/usb/devices");
    }
    ~CameraListTest() override { fs::remove_all(root_); }
    CameraListTest(const CameraListTest&) = delete;
    CameraListTest& operator=(const CameraListTest&) = delete;

    void write(const fs::path& file, const std::string& text) {
        fs::create_directories((root_ / file).parent_path());
        std::ofstream(root_ / file) << text << '\n';
    }

    void usb(const std::string& port, const std::string& product, const std::string& speed) {
        const std::string folder = "devices/usb/" + port + "/";
        write(folder + "idVendor", "2b03");
        write(folder + "idProduct", product);
        write(folder + "bcdDevice", "0142");
        write(folder + "serial", "S" + port);
        write(folder + "speed", speed);
        write(folder + "busnum", "2");
        write(folder + "devnum", "17");
        write(folder + "power/control", "auto");
        write(folder + "product", "ZED 2");
        fs::create_directory_symlink(root_ / folder, root_ / "bus/usb/devices" / port);
    }

    void video(const std::string& node, const std::string& device, const std::string& index) {
        const std::string folder = "devices/" + device + "/video4linux/" + node + "/";
        write(folder + "index", index);
        write(folder + "name", "a camera");
        fs::create_directory_symlink(root_ / "devices" / device, root_ / folder / "device");
        fs::create_directory_symlink(root_ / folder, root_ / "class/video4linux" / node);
    }

    std::vector<UsbCamera> list() const { return list_cameras(root_.string(), "/dev"); }

    fs::path root_;
};

TEST_F(CameraListTest, NodesInOrderWithTheirUsbFacts) {
    usb("2-1", "f780", "5000");
    video("video10", "usb/2-1/2-1:1.0", "0");
    video("video11", "usb/2-1/2-1:1.0", "1");
    video("video2", "platform/vivid.0", "0");
    const auto cameras = list();
    ASSERT_EQ(cameras.size(), 2U);
    EXPECT_EQ(cameras[0].node, "/dev/video2");
    EXPECT_EQ(cameras[0].port, "");
    EXPECT_EQ(cameras[0].place, "vivid.0");
    EXPECT_EQ(cameras[0].model(), "a camera");
    const UsbCamera& zed = cameras[1];
    EXPECT_EQ(zed.node, "/dev/video10");
    EXPECT_EQ(zed.port, "2-1");
    EXPECT_EQ(zed.place, "2-1:1.0");
    EXPECT_EQ(zed.vendor, 0x2b03);
    EXPECT_EQ(zed.product, 0xf780);
    EXPECT_EQ(firmware_text(zed.firmware), "1.42");
    EXPECT_EQ(zed.serial, "S2-1");
    EXPECT_EQ(zed.speed_mbit, 5000);
    EXPECT_EQ(zed.bus, 2);
    EXPECT_EQ(zed.address, 17);
    EXPECT_TRUE(zed.autosuspend);
    EXPECT_EQ(zed.model(), "ZED 2");
    EXPECT_EQ(zed.label(), "ZED 2 (serial S2-1, /dev/video10, USB port 2-1)");
    EXPECT_THAT(camera_notices(zed), ::testing::ElementsAre(HasSubstr("the kernel may suspend ZED 2")));
}

TEST_F(CameraListTest, AZedWithoutNodeIsListedAllTheSame) {
    usb("1-4", "f580", "480");
    usb("1-5", "f681", "12");  // sensors: no camera
    const auto cameras = list();
    ASSERT_EQ(cameras.size(), 1U);
    EXPECT_EQ(cameras[0].node, "");
    EXPECT_EQ(diagnose(cameras[0], parse_camera_uri("v4l2:vga"))->state, CameraState::old_firmware);
}

TEST_F(CameraListTest, NothingWhereTheKernelHasNoSuchDevices) {
    fs::remove_all(root_);
    EXPECT_TRUE(list().empty());
}

TEST(CameraUriTest, ModesSizesAndSelection) {
    const CameraRequest plain = parse_camera_uri("v4l2:");
    EXPECT_EQ(plain.mode, "hd720");
    EXPECT_EQ(plain.frame_width, 2560);
    EXPECT_EQ(plain.rate, 30);
    const CameraRequest first = parse_camera_uri("v4l2:auto");
    EXPECT_EQ(first.mode, "hd720");
    EXPECT_EQ(first.rate, 30);
    EXPECT_TRUE(first.zed_only()) << "a camera for video calls has no two eyes";
    EXPECT_EQ(parse_camera_uri("v4l2:auto@15").rate, 15);
    EXPECT_EQ(parse_camera_uri("v4l2:HD2K").rate, 15);
    const CameraRequest request =
        parse_camera_uri("v4l2:1280x960@7.5?format=grey&layout=top-bottom&serial=5&device=/dev/video7&port=1-2.3");
    EXPECT_EQ(request.mode, "");
    EXPECT_EQ(request.eye_width(), 1280);
    EXPECT_EQ(request.eye_height(), 480);
    EXPECT_EQ(request.rate, 7.5);
    EXPECT_EQ(request.format(), PixelFormat::grey8);
    EXPECT_FALSE(request.mjpeg());
    EXPECT_FALSE(request.right_first);
    const CameraRequest jpegs = parse_camera_uri("v4l2:2560x720@30?device=/dev/video0&format=mjpeg&first=right");
    EXPECT_EQ(jpegs.format(), PixelFormat::yuyv);
    EXPECT_TRUE(jpegs.mjpeg());
    EXPECT_TRUE(jpegs.right_first);
    const CameraRequest forced = parse_camera_uri("v4l2:1281x720?device=/dev/video0&format=y8i&force=Y16");
    EXPECT_EQ(forced.eye_width(), 1281);
    EXPECT_EQ(forced.forced, 0x20363159U);
    EXPECT_EQ(request.serial, "5");
    EXPECT_EQ(request.device, "/dev/video7");
    EXPECT_EQ(request.port, "1-2.3");
}

TEST(CameraUriTest, MistakesAreRefusedWithWhatIsAllowed) {
    const std::pair<const char*, const char*> mistakes[] = {
        {"v4l2:hd960", "allowed is auto, hd2k, hd1080, hd720, vga, or the size"},
        {"v4l2:0x720", "16 to 16384"},
        {"v4l2:2560x720@0", "1 to 1000"},
        {"v4l2:2560x720@", "1 to 1000"},
        {"v4l2:vga?serial", "with a value"},
        {"v4l2:vga?colour=red", "serial, device, port, left, right, within_ms, format, force, layout or first"},
        {"v4l2:vga?format=h264", "yuyv, grey, mjpeg, y8i, y12i, bggr8, gbrg8, grbg8 or rggb8"},
        {"v4l2:1281x720?format=y8i&layout=top-bottom", "side-by-side with a format whose"},
        {"v4l2:1280x720?force=Y16LE", "1 to 4 characters"},
        {"v4l2:vga?first=top", "left or right: the eye"},
        {"v4l2:1282x720", "a multiple of 4"},
        {"v4l2:1280x721?layout=top-bottom", "an even height"},
        {"v4l2:vga?device=/dev/video0,/dev/video2", "two cameras are left=/dev/video0&right=/dev/video2"},
        {"v4l2:vga?device=/dev/video0&device=/dev/video2", "each parameter once"},
    };
    for (const auto& [uri, part] : mistakes) {
        try {
            parse_camera_uri(uri);
            ADD_FAILURE() << uri << " was taken";
        } catch (const std::invalid_argument& error) {
            EXPECT_THAT(error.what(), HasSubstr(part)) << uri;
        }
    }
}

TEST(CameraUriTest, AModeOfZedCamerasMeansAZedAndASizeAZedFirst) {
    UsbCamera webcam;
    webcam.node = "/dev/video0";
    UsbCamera zed;
    zed.node = "/dev/video2";
    zed.vendor = zed_vendor;
    zed.product = 0xf780;
    const std::vector<UsbCamera> both = {webcam, zed};
    for (const char* uri : {"v4l2:", "v4l2:vga@15", "v4l2:vga?serial=12345"}) {
        ASSERT_EQ(candidates(both, parse_camera_uri(uri)).size(), 1U) << uri;
        EXPECT_EQ(candidates(both, parse_camera_uri(uri))[0].node, "/dev/video2");
    }
    ASSERT_EQ(candidates(both, parse_camera_uri("v4l2:2560x720")).size(), 2U);
    EXPECT_EQ(candidates(both, parse_camera_uri("v4l2:2560x720"))[0].node, "/dev/video2");
    EXPECT_EQ(candidates(both, parse_camera_uri("v4l2:?device=/dev/video0")).size(), 1U);
}

TEST(CameraUriTest, TwoCamerasAreNamedEachAndWhatHasNoMeaningThenIsRefused) {
    const std::pair<const char*, const char*> refused[] = {
        {"v4l2:64x16?left=/dev/video0", "left= and right="},
        {"v4l2:64x16?right=port:1-1", "left= and right="},
        {"v4l2:64x16?left=/dev/video0&right=/dev/video0", "two cameras"},
        {"v4l2:64x16?left=/dev/video0&right=/dev/v4l/../video0", "two cameras"},
        {"v4l2:64x16?left=/dev/v4l/by-id/usb-X_A1-video-index0&right=/dev/v4l/by-id/usb-X_A1-video-index1",
         "two cameras"},
        {"v4l2:64x16?left=serial:A1&right=/dev/v4l/by-id/usb-X_A1-video-index0", "two cameras"},
        {"v4l2:64x16?left=port:&right=/dev/video0", "port:USB-PORT"},
        {"v4l2:64x16?left=a&right=b&device=c", "one camera of both eyes"},
        {"v4l2:64x16?left=a&right=b&first=right", "one camera of both eyes"},
        {"v4l2:64x16?left=a&right=b&layout=top-bottom", "one camera of both eyes"},
        {"v4l2:64x16?left=a&right=b&format=y8i", "one camera of both eyes"},
        {"v4l2:hd720?left=a&right=b", "such as 640x480"},
        {"v4l2:66x16?left=a&right=b", "multiple of 4"},
        {"v4l2:64x16@30?left=a&right=b&within_ms=17", "0.001 to 16.666"},
        {"v4l2:64x16@30?left=a&right=b&within_ms=0", "0.001 to 16.666"},
        {"v4l2:64x16@30?device=a&within_ms=5", "beside left= and right="},
        {"v4l2:64x16@30?device=/dev/video0,/dev/video2", "left=/dev/video0&right=/dev/video2"},
    };
    for (const auto& [uri, allowed] : refused) {
        try {
            parse_camera_uri(uri);
            ADD_FAILURE() << uri << " was taken";
        } catch (const std::invalid_argument& error) {
            EXPECT_THAT(error.what(), HasSubstr(allowed)) << uri;
        }
    }
    const CameraRequest request = parse_camera_uri("v4l2:64x16@50?left=/dev/a,b c&right=./port:1");
    EXPECT_EQ(request.device, "/dev/a,b c") << "paths may have commas";
    EXPECT_EQ(request.right->device, "./port:1");
    EXPECT_EQ(request.within_ns, 10'000'000) << "half of the interval";
    EXPECT_EQ(request.eye_width(), 64);
}

}  // namespace
}  // namespace disparityd::capture
