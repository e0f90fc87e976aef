// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/zed_extension.h"

#include <algorithm>
#include <array>
#include <cerrno>

#include <linux/usb/video.h>
#include <linux/uvcvideo.h>

#include "base/failure_text.h"

namespace disparityd::capture {

namespace {

constexpr std::uint8_t unit = 4;
constexpr std::uint8_t selector = 2;
constexpr std::size_t answer_head = 17;
constexpr std::size_t longest_command = 384;

constexpr std::uint32_t serial_address = 0x18000;
constexpr std::uint16_t serial_bytes = 64;

/// The camera needs so long to read from its flash.
constexpr std::chrono::microseconds flash_time{2000};
/// The camera needs so long to read a register.
constexpr std::chrono::microseconds register_time{300};

void put_be16(ZedCommand& command, std::size_t at, unsigned value) {
    command[at] = static_cast<std::uint8_t>(value >> 8U);
    command[at + 1] = static_cast<std::uint8_t>(value);
}

ZedCommand register_command(std::size_t length, ZedPart part, std::uint32_t address) {
    const bool processor = part == ZedPart::processor;
    ZedCommand command(length);
    command[1] = static_cast<std::uint8_t>(part);
    command[2] = processor ? 0 : 0x6c;
    command[3] = processor ? 4 : 2;  // bytes of the address
    command[4] = 1;                  // bytes of the value
    put_be16(command, 5, address >> 16U);
    put_be16(command, 7, address & 0xffffU);
    put_be16(command, 9, processor ? 1 : 0x9001);
    put_be16(command, 11, 1);
    return command;
}

}  // namespace

ZedCommand zed_flash_read(std::size_t length, std::uint32_t address, std::uint16_t count) {
    ZedCommand command(length);
    command[0] = 0x51;  // get
    command[1] = 0xa1;  // from flash
    command[2] = 3;
    put_be16(command, 5, address >> 16U);
    put_be16(command, 7, address & 0xffffU);
    put_be16(command, 9, 0x9000U + count);
    put_be16(command, 11, count);
    return command;
}

ZedCommand zed_register_read(std::size_t length, ZedPart part, std::uint32_t address) {
    ZedCommand command = register_command(length, part, address);
    command[0] = 0x51;
    return command;
}

ZedCommand zed_register_write(std::size_t length, ZedPart part, std::uint32_t address, std::uint8_t value) {
    ZedCommand command = register_command(length, part, address);
    command[0] = 0x50;
    command[16] = value;
    return command;
}

std::optional<std::vector<std::uint8_t>> zed_answer(std::span<const std::uint8_t> answer, std::size_t count) {
    if (answer.size() < answer_head || answer.size() - answer_head < count) {
        return std::nullopt;
    }
    const auto data = answer.subspan(answer_head, count);
    return std::vector<std::uint8_t>(data.begin(), data.end());
}

std::string zed_serial(std::span<const std::uint8_t> flash) {
    if (flash.size() < 6 || flash[0] != 'O' || flash[1] != 'V') {
        return {};
    }
    std::string digits;
    for (const std::uint8_t byte : flash.subspan(2, 4)) {
        for (const unsigned digit : {unsigned{byte} >> 4U, unsigned{byte} & 0xfU}) {
            if (digit > 9) {
                return {};
            }
            if (digit != 0 || !digits.empty()) {
                digits += static_cast<char>('0' + digit);
            }
        }
    }
    return digits;
}

ZedError::ZedError(int number)
    : std::runtime_error("the camera's extension unit does not answer: " + base::error_text(number)), code(number) {}

ZedUnit::ZedUnit(VideoSystem& system, int device) : system_(system), device_(device) {
    std::array<std::uint8_t, 2> bytes{};
    query(UVC_GET_LEN, bytes);
    length_ = bytes[0] + (std::size_t{bytes[1]} << 8U);
    if (length_ <= answer_head || length_ > longest_command) {
        throw ZedError(EPROTO);
    }
}

void ZedUnit::query(std::uint8_t what, std::span<std::uint8_t> data) {
    uvc_xu_control_query request{};
    request.unit = unit;
    request.selector = selector;
    request.query = what;
    request.size = static_cast<std::uint16_t>(data.size());
    request.data = data.data();
    if (const int code = system_.ioctl(device_, UVCIOC_CTRL_QUERY, &request); code != 0) {
        throw ZedError(code);
    }
}

std::vector<std::uint8_t> ZedUnit::ask(ZedCommand command, std::size_t count, std::chrono::microseconds time) {
    query(UVC_SET_CUR, command);
    system_.wait(-1, nobody_, system_.now() + time);
    query(UVC_GET_CUR, command);
    const auto data = zed_answer(command, count);
    if (!data) {
        throw ZedError(EPROTO);
    }
    return *data;
}

std::uint8_t ZedUnit::read(ZedPart part, std::uint32_t address) {
    return ask(zed_register_read(length_, part, address), 1, register_time)[0];
}

void ZedUnit::write(ZedPart part, std::uint32_t address, std::uint8_t value) {
    ZedCommand command = zed_register_write(length_, part, address, value);
    query(UVC_SET_CUR, command);
}

std::string ZedUnit::serial() {
    // USB 2 has room for less than the whole block; the number stands at its beginning.
    const auto count = static_cast<std::uint16_t>(std::min<std::size_t>(serial_bytes, length_ - answer_head));
    return zed_serial(ask(zed_flash_read(length_, serial_address, count), count, flash_time));
}

ZedSerial read_zed_serial(VideoSystem& system, const std::string& node) {
    const int device = system.open(node);
    if (device < 0) {
        return {"", -device};
    }
    ZedSerial serial;
    try {
        serial.text = ZedUnit(system, device).serial();
    } catch (const ZedError& error) {
        serial.code = error.code;
    }
    system.close(device);
    return serial;
}

}  // namespace disparityd::capture
