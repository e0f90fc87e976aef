// SPDX-License-Identifier: Apache-2.0
//
// The camera's extension unit through the kernel: what the daemon reads serial number and exposure from.
#include <gtest/gtest.h>

#include "tests/vm/guest/camera_process.h"
#include "tests/vm/guest/extension_client.h"

namespace vm_guest {
namespace {

using Bytes = ExtensionClient::Bytes;

const Bytes read_serial_from_flash{0x51, 0xa1, 3, 0, 0, 0x00, 0x01, 0x80, 0x00, 0x90, 0x40, 0x00, 0x40};

TEST(Extension, SerialNumberFromTheFlashOnBothLinks) {
    for (const bool usb2 : {false, true}) {
        const CameraProcess camera(usb2 ? std::vector<std::string>{"--serial", "21531", "--usb2"}
                                        : std::vector<std::string>{"--serial", "21531"});
        const ExtensionClient unit(camera.node().path);
        EXPECT_EQ(unit.command_bytes(), usb2 ? 64U : 384U);
        const Bytes answer = unit.ask(read_serial_from_flash);
        EXPECT_EQ(Bytes(answer.begin() + 17, answer.begin() + 23), (Bytes{'O', 'V', 0x00, 0x02, 0x15, 0x31}));
    }
}

TEST(Extension, ExposureOfEachSensorIsKept) {
    const CameraProcess camera;
    const ExtensionClient unit(camera.node().path);
    unit.write_sensor(ExtensionClient::left, 0x3501, 0x55);
    unit.write_sensor(ExtensionClient::right, 0x3501, 0x66);
    EXPECT_EQ(unit.read_sensor(ExtensionClient::left, 0x3501), 0x55);
    EXPECT_EQ(unit.read_sensor(ExtensionClient::right, 0x3501), 0x66);
}

}  // namespace
}  // namespace vm_guest
