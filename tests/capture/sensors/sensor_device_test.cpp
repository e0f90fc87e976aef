// SPDX-License-Identifier: Apache-2.0
#include "capture/sensors/sensor_device.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/capture/camera/fake_camera.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::capture {
namespace {

namespace fs = std::filesystem;

SensorDevice device(const std::string& node, const std::string& port, const std::string& serial,
                    std::uint16_t product = 0xf781) {
    return {node, port, zed_vendor, product, 0x0308, serial};
}

std::string chosen(const UsbCamera& camera, const std::vector<SensorDevice>& devices) {
    const auto found = sensors_of(camera, devices);
    return found ? found->node : "none";
}

UsbCamera zed(const std::string& port, const std::string& serial) {
    UsbCamera camera = test::zed2("/dev/video0", serial).usb;
    camera.port = port;
    return camera;
}

TEST(SensorDevices, AreThoseWithTheCamerasSerial) {
    const std::vector devices{device("a", "1-2", "12344"), device("b", "1-1", "00012345"), device("c", "3-1", "")};
    EXPECT_EQ(chosen(zed("2-9", "12345"), devices), "b");
    EXPECT_EQ(chosen(zed("2-9", "777"), {devices[0], devices[1]}), "none") << "both belong to others";
    EXPECT_EQ(chosen(zed("2-9", "777"), devices), "c") << "the only one that is nobody else's";
}

TEST(SensorDevices, WithoutSerialAreTheOnlyOnesOrBesideTheCamera) {
    const SensorDevice here = device("a", "1-1.3.2", "5");
    const SensorDevice there = device("b", "1-1.4.2", "6");
    EXPECT_EQ(chosen(zed("2-1.3.1", ""), {here}), "a");
    EXPECT_EQ(chosen(zed("2-1.3.1", ""), {here, there}), "a");
    EXPECT_EQ(chosen(zed("2-1.4.1", ""), {here, there}), "b");
    EXPECT_EQ(chosen(zed("2-1.5.1", ""), {here, there}), "none");
    EXPECT_EQ(chosen(zed("2-1", ""), {here, there}), "none");
    EXPECT_EQ(chosen(zed("", ""), {}), "none");
}

TEST(SensorDevices, AreOfTheRightModel) {
    EXPECT_EQ(chosen(zed("2-1", "5"), {device("a", "1-1", "5", 0xf681)}), "none");
    UsbCamera first = zed("2-1", "5");
    first.product = 0xf582;
    EXPECT_EQ(chosen(first, {device("a", "1-1", "5")}), "none") << "a ZED has no sensors";
    UsbCamera other;
    EXPECT_EQ(chosen(other, {device("a", "1-1", "5", 0)}), "none");
}

TEST(SensorDevices, AreListedFromSysfs) {
    const test::TemporaryFolder folder;
    const fs::path root = folder.file("sys");
    const auto add = [&root](const std::string& node, const std::string& port, const std::string& vendor) {
        const fs::path usb = root / "devices/usb1" / port;
        const fs::path hid = usb / (port + ":1.0") / ("0003:" + node);
        fs::create_directories(hid / "hidraw" / node);
        for (const auto& [name, text] : {std::pair{"idVendor", vendor},
                                         {"idProduct", std::string("f781")},
                                         {"bcdDevice", std::string("0309")},
                                         {"serial", "S" + port}}) {
            std::ofstream(usb / name) << text << '\n';
        }
        fs::create_directory_symlink(hid, hid / "hidraw" / node / "device");
        fs::create_directories(root / "class/hidraw");
        fs::create_directory_symlink(hid / "hidraw" / node, root / "class/hidraw" / node);
    };
    add("hidraw10", "1-1.2", "2b03");
    add("hidraw2", "1-4", "046d");
    add("hidraw9", "1-2", "2b03");
    fs::create_directories(root / "class/hidraw/hidraw11");
    const auto devices = list_sensor_devices(root.string(), "/dev");
    ASSERT_EQ(devices.size(), 2U);
    EXPECT_EQ(devices[0].node, "/dev/hidraw9");
    EXPECT_EQ(devices[1].node, "/dev/hidraw10");
    EXPECT_EQ(devices[1].port, "1-1.2");
    EXPECT_EQ(devices[1].product, 0xf781);
    EXPECT_EQ(devices[1].firmware, 0x0309);
    EXPECT_EQ(devices[1].serial, "S1-1.2");
    EXPECT_TRUE(list_sensor_devices(folder.file("nowhere"), "/dev").empty());
}

}  // namespace
}  // namespace disparityd::capture
