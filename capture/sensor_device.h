// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "capture/usb_camera.h"

namespace disparityd::capture {

/// A HID device on the USB as sysfs shows it; nothing is opened to know this.
struct SensorDevice {
    std::string node;  ///< "/dev/hidraw0"
    std::string port;  ///< place on the bus, such as "1-1.2"
    std::uint16_t vendor = 0;
    std::uint16_t product = 0;
    std::uint16_t firmware = 0;  ///< bcdDevice
    std::string serial;          ///< of the USB descriptor
};

/// Those whose vendor makes ZED cameras, in order of their nodes. Folders that vanish meanwhile are left out.
std::vector<SensorDevice> list_sensor_devices(const std::string& sys = "/sys", const std::string& dev = "/dev");

/// The one that is built into this camera: a device of its own, on the USB 2 side of the hub inside the camera. It has
/// the camera's serial number; where one of the two has none, it is the only one that is left, or the only one beside
/// the camera in the same hub. Nothing when that leaves it open.
std::optional<SensorDevice> sensors_of(const UsbCamera& camera, const std::vector<SensorDevice>& devices);

}  // namespace disparityd::capture
