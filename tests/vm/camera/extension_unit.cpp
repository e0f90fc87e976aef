// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/camera/extension_unit.h"

#include <algorithm>

namespace simulated_camera {

namespace {

using std::chrono::microseconds;

constexpr std::uint8_t command_selector = 2;

// Places in a command and in its answer.
constexpr std::size_t operation_at = 0;
constexpr std::size_t target_at = 1;
constexpr std::size_t address_at = 5;
constexpr std::size_t count_at = 11;
constexpr std::size_t value_at = 16;
constexpr std::size_t answer_at = 17;

enum Operation : std::uint8_t { write = 0x50, read = 0x51 };
enum Target : std::uint8_t { flash = 0xa1, image_processor = 0xa2, left_sensor = 0xa3, right_sensor = 0xa5 };

constexpr microseconds register_time{300};
constexpr microseconds flash_time{2000};

constexpr std::uint32_t serial_address = 0x18000;
constexpr std::size_t serial_bytes = 64;
constexpr std::uint8_t automatic_exposure_and_gain = 0x02;

// "OV", then the decimal digits of the serial number as hexadecimal ones, most significant first.
Bytes flash_with_serial(std::uint32_t serial) {
    Bytes bytes(serial_bytes, 0xff);
    bytes[0] = 'O';
    bytes[1] = 'V';
    for (std::size_t at = 5; at >= 2; --at) {
        bytes[at] = static_cast<std::uint8_t>(serial % 10 | (serial / 10 % 10) << 4);
        serial /= 100;
    }
    return bytes;
}

}  // namespace

ExtensionUnit::ExtensionUnit(const CameraOptions& camera)
    : command_bytes_(camera.link == Link::usb3 ? 384 : 64),
      flash_serial_(flash_with_serial(camera.serial)),
      answer_(command_bytes_) {
    registers_[{image_processor, 0x80181033}] = automatic_exposure_and_gain;
    registers_[{image_processor, 0x80181833}] = automatic_exposure_and_gain;
    for (const std::uint8_t sensor : {left_sensor, right_sensor}) {
        registers_[{sensor, 0x3501}] = 0x20;  // exposure: 512 lines
        registers_[{sensor, 0x3509}] = 0x40;  // gain
    }
}

void ExtensionUnit::read_flash(std::uint32_t address, std::size_t count) {
    for (std::size_t i = 0; i < count && answer_at + i < answer_.size(); ++i) {
        const std::size_t place = address - serial_address + i;
        answer_[answer_at + i] = place < flash_serial_.size() ? flash_serial_[place] : 0xff;
    }
}

void ExtensionUnit::execute(std::span<const std::uint8_t> command) {
    answer_.assign(command_bytes_, 0);
    const std::uint8_t target = command[target_at];
    const std::uint32_t address = get_big_endian(command, address_at, 4);
    ready_at_ = Clock::now() + (target == flash ? flash_time : register_time);
    if (target == flash && command[operation_at] == read) {
        read_flash(address, get_big_endian(command, count_at, 2));
    } else if (command[operation_at] == read) {
        answer_[answer_at] = registers_[{target, address}];
    } else if (command[operation_at] == write && target != flash) {
        registers_[{target, address}] = command[value_at];
    }
}

ControlAnswer ExtensionUnit::answer(const SetupPacket& setup, std::span<const std::uint8_t> data) {
    if (setup.value_high() != command_selector) {
        return std::nullopt;
    }
    Bytes bytes;
    switch (setup.request) {
        case uvc_request::set_cur:
            if (data.size() != command_bytes_) {
                return std::nullopt;
            }
            execute(data);
            return bytes;
        case uvc_request::get_cur: return Clock::now() < ready_at_ ? Bytes(command_bytes_) : answer_;
        case uvc_request::get_len: append_little_endian(bytes, command_bytes_, 2); return bytes;
        case uvc_request::get_info: return Bytes{readable_and_writable};
        case uvc_request::get_min:
        case uvc_request::get_def: return Bytes(command_bytes_, 0);
        case uvc_request::get_max: return Bytes(command_bytes_, 0xff);
        case uvc_request::get_res: return Bytes(command_bytes_, 1);
        default: return std::nullopt;
    }
}

}  // namespace simulated_camera
