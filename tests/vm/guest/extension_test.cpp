// SPDX-License-Identifier: Apache-2.0
//
// The camera's extension unit through the kernel: what the daemon reads serial number and exposure from.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/usb/video.h>
#include <linux/uvcvideo.h>
#include <sys/ioctl.h>

#include "tests/vm/camera/file_descriptor.h"
#include "tests/vm/guest/camera_process.h"
#include "tests/vm/guest/waiting.h"

namespace vm_guest {
namespace {

using Bytes = std::vector<std::uint8_t>;

class ExtensionUnit {
public:
    explicit ExtensionUnit(const CameraProcess& camera)
        : device_(::open(camera.node().path.c_str(), O_RDWR | O_CLOEXEC)) {}

    std::size_t command_bytes() const {
        Bytes length(2);
        query(UVC_GET_LEN, length);
        return static_cast<std::size_t>(length[0] | length[1] << 8);
    }

    Bytes ask(Bytes command) const {
        command.resize(command_bytes());
        query(UVC_SET_CUR, command);
        std::this_thread::sleep_for(milliseconds(3));  // the flash takes 2 ms
        query(UVC_GET_CUR, command);
        return command;
    }

private:
    void query(std::uint8_t request, Bytes& data) const {
        uvc_xu_control_query query{4, 2, request, static_cast<std::uint16_t>(data.size()), data.data()};
        EXPECT_EQ(::ioctl(device_.get(), UVCIOC_CTRL_QUERY, &query), 0) << "request " << int(request);
    }

    simulated_camera::FileDescriptor device_;
};

const Bytes read_serial_from_flash{0x51, 0xa1, 3, 0, 0, 0x00, 0x01, 0x80, 0x00, 0x90, 0x40, 0x00, 0x40};

TEST(Extension, SerialNumberFromTheFlashOnBothLinks) {
    for (const bool usb2 : {false, true}) {
        const CameraProcess camera(usb2 ? std::vector<std::string>{"--serial", "21531", "--usb2"}
                                        : std::vector<std::string>{"--serial", "21531"});
        const ExtensionUnit unit(camera);
        EXPECT_EQ(unit.command_bytes(), usb2 ? 64U : 384U);
        const Bytes answer = unit.ask(read_serial_from_flash);
        EXPECT_EQ(Bytes(answer.begin() + 17, answer.begin() + 23), (Bytes{'O', 'V', 0x00, 0x02, 0x15, 0x31}));
    }
}

TEST(Extension, ExposureOfEachSensorIsKept) {
    const CameraProcess camera;
    const ExtensionUnit unit(camera);
    const auto sensor = [](std::uint8_t operation, std::uint8_t eye, std::uint8_t value) {
        return Bytes{operation, eye, 0x6c, 2, 1, 0, 0, 0x35, 0x01, 0x90, 1, 0, 1, 0, 0, 0, value};
    };
    unit.ask(sensor(0x50, 0xa3, 0x55));
    unit.ask(sensor(0x50, 0xa5, 0x66));
    EXPECT_EQ(unit.ask(sensor(0x51, 0xa3, 0))[17], 0x55);
    EXPECT_EQ(unit.ask(sensor(0x51, 0xa5, 0))[17], 0x66);
}

}  // namespace
}  // namespace vm_guest
