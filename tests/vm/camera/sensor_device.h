// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>

#include "tests/vm/camera/camera_model.h"
#include "tests/vm/camera/file_descriptor.h"
#include "tests/vm/camera/usb_request.h"
#include "tests/vm/camera/usbip.h"

namespace simulated_camera {

/// The sensors of a camera, from plug to unplug: a HID device of their own beside the video device. Sends reports while
/// it is switched on and hears a ping at least every six seconds.
class SensorDevice {
public:
    SensorDevice(const CameraOptions& camera, FileDescriptor socket);

    /// To wait on: readable means handle_message() or handle_timer().
    int socket() const { return host_.socket(); }
    int timer() const { return timer_.get(); }

    /// Takes one message of the host; false once it has gone.
    bool handle_message();
    void handle_timer();

private:
    ControlAnswer control(const SetupPacket& setup, std::span<const std::uint8_t> data);
    ControlAnswer find_descriptor(std::uint8_t type, std::uint8_t index) const;
    ControlAnswer set_report(std::span<const std::uint8_t> report);

    CameraOptions camera_;
    UsbIpConnection host_;
    FileDescriptor timer_;
    std::deque<std::uint32_t> waiting_;  ///< sequences of transfers that take a report
    bool on_ = false;
    std::int64_t pinged_ns_ = 0;
    std::uint32_t number_ = 0;
};

}  // namespace simulated_camera
