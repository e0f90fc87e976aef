// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "capture/usb/usb_camera.h"

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

/// Lists the HID devices of the vendor of ZED cameras, in order of their nodes. Folders that vanish meanwhile are left
/// out.
std::vector<SensorDevice> list_sensor_devices(const std::string& sys = "/sys", const std::string& dev = "/dev");

/// Finds the device that is built into this camera, on the USB 2 side of the hub inside it. It has the camera's serial
/// number; where one of the two has none, it is the only device left, or the only one in the camera's hub. Returns
/// nullopt when that leaves a choice.
std::optional<SensorDevice> sensors_of(const UsbCamera& camera, const std::vector<SensorDevice>& devices);

}  // namespace disparityd::capture
