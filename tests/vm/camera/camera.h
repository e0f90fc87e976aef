// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "tests/vm/camera/sensor_device.h"
#include "tests/vm/camera/usb_device.h"

namespace simulated_camera {

/// A camera and what happens to it: plugged and unplugged, made to fail.
class Camera {
public:
    using Plug = std::function<FileDescriptor(Link)>;

    /// `plug` gives the device's end of a USB/IP connection. Starts unplugged.
    Camera(const CameraOptions& options, Plug plug);

    /// Does nothing when it is plugged in already. Throws what `plug` throws.
    void plug_in();
    /// Ends all faults, too.
    void unplug();

    /// Another camera takes its place with the next plug_in().
    void become(const Model& model, std::uint32_t serial);

    Faults& faults() { return faults_; }
    void thaw();

    /// One line: whether it is plugged in and streams, and its counters.
    std::string describe() const;

    /// To wait on: readable means handle_host() or handle_timer(). -1 while unplugged.
    int host_socket() const { return device_ ? device_->socket() : -1; }
    int timer() const { return timer_.get(); }
    void handle_host();
    void handle_timer();

    /// Where the camera has some and is plugged in; to wait on as well.
    std::optional<SensorDevice>& sensors() { return sensors_; }

private:
    void set_timer();

    CameraOptions options_;
    Plug plug_;
    FrameFeed feed_;
    Faults faults_;
    StreamCounters counters_;
    std::optional<UsbDevice> device_;
    std::optional<SensorDevice> sensors_;
    FileDescriptor timer_;
    std::uint32_t timer_interval_ = 0;  // 100 ns; 0: off
};

}  // namespace simulated_camera
