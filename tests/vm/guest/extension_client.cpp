// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/guest/extension_client.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/usb/video.h>
#include <linux/uvcvideo.h>
#include <sys/ioctl.h>

#include "tests/vm/guest/waiting.h"

namespace vm_guest {

namespace {

ExtensionClient::Bytes sensor_command(std::uint8_t operation, std::uint8_t eye, std::uint16_t address,
                                      std::uint8_t value) {
    const auto high = static_cast<std::uint8_t>(address >> 8U);
    const auto low = static_cast<std::uint8_t>(address & 0xffU);
    return {operation, eye, 0x6c, 2, 1, 0, 0, high, low, 0x90, 1, 0, 1, 0, 0, 0, value};
}

}  // namespace

ExtensionClient::ExtensionClient(const std::string& node) : device_(::open(node.c_str(), O_RDWR | O_CLOEXEC)) {}

std::size_t ExtensionClient::command_bytes() const {
    Bytes length(2);
    query(UVC_GET_LEN, length);
    return static_cast<std::size_t>(length[0] | length[1] << 8);
}

ExtensionClient::Bytes ExtensionClient::ask(Bytes command) const {
    command.resize(command_bytes());
    query(UVC_SET_CUR, command);
    std::this_thread::sleep_for(milliseconds(3));  // the flash takes 2 ms
    query(UVC_GET_CUR, command);
    return command;
}

std::uint8_t ExtensionClient::read_sensor(std::uint8_t eye, std::uint16_t address) const {
    return ask(sensor_command(0x51, eye, address, 0))[17];
}

void ExtensionClient::write_sensor(std::uint8_t eye, std::uint16_t address, std::uint8_t value) const {
    ask(sensor_command(0x50, eye, address, value));
}

int ExtensionClient::exposure(std::uint8_t eye) const {
    const int sixteenths = read_sensor(eye, 0x3500) << 16 | read_sensor(eye, 0x3501) << 8 | read_sensor(eye, 0x3502);
    return sixteenths / 16;
}

void ExtensionClient::query(std::uint8_t request, Bytes& data) const {
    uvc_xu_control_query query{4, 2, request, static_cast<std::uint16_t>(data.size()), data.data()};
    EXPECT_EQ(::ioctl(device_.get(), UVCIOC_CTRL_QUERY, &query), 0) << "request " << int(request);
}

}  // namespace vm_guest
