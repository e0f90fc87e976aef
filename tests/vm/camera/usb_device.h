// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/vm/camera/extension_unit.h"
#include "tests/vm/camera/picture_controls.h"
#include "tests/vm/camera/stream_settings.h"
#include "tests/vm/camera/video_stream.h"

namespace simulated_camera {

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
