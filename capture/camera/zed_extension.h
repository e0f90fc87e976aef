// SPDX-License-Identifier: Apache-2.0
//
// What a ZED camera says and takes through the extension unit of its USB video function. The layout of the commands is
// a fact of the cameras; their maker's published open capture library (zed-open-capture) uses the same.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "capture/camera/video_system.h"

namespace disparityd::capture {

/// Bytes of a command and its answer. USB 3 has 384, USB 2 has 64.
using ZedCommand = std::vector<std::uint8_t>;

/// Reads `count` bytes (at most what fits behind the answer's head) of the camera's flash memory.
ZedCommand zed_flash_read(std::size_t length, std::uint32_t address, std::uint16_t count);

/// The answer's data, or nothing when it is too short for them.
std::optional<std::vector<std::uint8_t>> zed_answer(std::span<const std::uint8_t> answer, std::size_t count);

/// The serial number in the 64 bytes of flash that hold it: "OV", then four bytes whose hexadecimal digits are the
/// number. Empty when they hold something else.
std::string zed_serial(std::span<const std::uint8_t> flash);

/// One of the camera's two sensors, or the processor behind them.
enum class ZedPart : std::uint8_t { processor = 0xa2, left_sensor = 0xa3, right_sensor = 0xa5 };

/// Reads or sets one byte of a register.
ZedCommand zed_register_read(std::size_t length, ZedPart part, std::uint32_t address);
ZedCommand zed_register_write(std::size_t length, ZedPart part, std::uint32_t address, std::uint8_t value);

/// The extension unit of an open camera. One thread; a question takes the camera some milliseconds. Errors are
/// ZedError with errno.
class ZedError : public std::runtime_error {
public:
    explicit ZedError(int number);
    const int code;
};

class ZedUnit {
public:
    ZedUnit(VideoSystem& system, int device);

    std::uint8_t read(ZedPart part, std::uint32_t address);
    void write(ZedPart part, std::uint32_t address, std::uint8_t value);

    /// Empty when the camera holds none.
    std::string serial();

private:
    void query(std::uint8_t what, std::span<std::uint8_t> data);
    std::vector<std::uint8_t> ask(ZedCommand command, std::size_t count, std::chrono::microseconds time);

    VideoSystem& system_;
    const int device_;
    base::Waker nobody_;
    std::size_t length_ = 0;
};

/// Opens a camera and asks it for its serial number. `code` is 0, or the errno of what failed; then the text is empty.
struct ZedSerial {
    std::string text;
    int code = 0;
};
ZedSerial read_zed_serial(VideoSystem& system, const std::string& node);

}  // namespace disparityd::capture
