// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <map>
#include <utility>

#include "tests/vm/camera/camera_model.h"
#include "tests/vm/camera/usb_request.h"

namespace simulated_camera {

/// The vendor's way into the camera: commands that read and write registers of the image processor and of both sensors
/// (exposure, gain, their automatic) and read the flash (serial number). A command is written with SET_CUR; the answer
/// lies ready some time later, whoever fetches it too early gets zeros.
class ExtensionUnit {
public:
    explicit ExtensionUnit(const CameraOptions& camera);

    ControlAnswer answer(const SetupPacket& setup, std::span<const std::uint8_t> data);

    /// Bytes of a command and of its answer.
    std::size_t command_bytes() const { return command_bytes_; }

private:
    using Clock = std::chrono::steady_clock;

    void execute(std::span<const std::uint8_t> command);
    void read_flash(std::uint32_t address, std::size_t count);

    std::size_t command_bytes_;
    Bytes flash_serial_;                                                        // from serial_address on
    std::map<std::pair<std::uint8_t, std::uint32_t>, std::uint8_t> registers_;  // by target and address
    Bytes answer_;
    Clock::time_point ready_at_;
};

}  // namespace simulated_camera
