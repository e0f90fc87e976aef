// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "tests/vm/camera/extension_unit.h"
#include "tests/vm/camera/stream_settings.h"
#include "tests/vm/camera/usb_request.h"
#include "tests/vm/camera/video_stream.h"

namespace simulated_camera {

/// Brightness, contrast and the like: controls of the processing unit that keep what they are set to. The picture does
/// not depend on them.
class PictureControls {
public:
    ControlAnswer answer(const SetupPacket& setup, std::span<const std::uint8_t> data);

private:
    struct Control {
        std::uint8_t selector;
        std::uint8_t length;
        std::uint16_t lowest;
        std::uint16_t highest;
        std::uint16_t step;
        std::uint16_t usual;
        std::uint16_t now;
    };

    static ControlAnswer read(const Control& control, std::uint8_t request);

    std::array<Control, 8> controls_{{{0x02, 2, 0, 8, 1, 4, 4},                // brightness
                                      {0x03, 2, 0, 8, 1, 4, 4},                // contrast
                                      {0x06, 2, 0, 11, 1, 0, 0},               // hue
                                      {0x07, 2, 0, 8, 1, 4, 4},                // saturation
                                      {0x08, 2, 0, 8, 1, 4, 4},                // sharpness
                                      {0x09, 2, 1, 9, 1, 8, 8},                // gamma
                                      {0x0a, 2, 2800, 6500, 100, 4600, 4600},  // white balance, kelvin
                                      {0x0b, 1, 0, 1, 1, 1, 1}}};              // white balance by itself
};

/// A camera from plug to unplug: answers control transfers, starts and stops the stream as the host says.
class UsbDevice {
public:
    UsbDevice(const CameraOptions& camera, FileDescriptor socket, FrameFeed& feed, Faults& faults,
              StreamCounters& counters);

    int socket() const { return host_.socket(); }

    /// Takes one message of the host; false once it has gone.
    bool handle_message();

    VideoStream& stream() { return stream_; }
    /// Between two frames, in units of 100 ns.
    std::uint32_t interval() const { return settings_.interval(); }

private:
    void handle(Submission submission);
    void handle(const Withdrawal& withdrawal);
    ControlAnswer control(const SetupPacket& setup, std::span<const std::uint8_t> data);
    ControlAnswer standard_request(const SetupPacket& setup);
    ControlAnswer class_request(const SetupPacket& setup, std::span<const std::uint8_t> data);
    void start_stream();
    void stop_stream();
    void end_freeze(FrozenUntil event);

    CameraOptions camera_;
    Faults& faults_;
    UsbIpConnection host_;
    PictureControls picture_controls_;
    ExtensionUnit extension_unit_;
    StreamSettings settings_;
    VideoStream stream_;
};

}  // namespace simulated_camera
