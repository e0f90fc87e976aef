// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "capture/usb/zed_cameras.h"

namespace disparityd::capture {

/// A camera as sysfs shows it; nothing is opened to know this. Fields of USB are empty or 0 for other cameras.
struct UsbCamera {
    std::string node;  ///< "/dev/video0"; empty: the kernel gave it none
    std::string name;  ///< what the driver or the device calls it
    std::string port;  ///< place on the bus, such as "2-1.4": stays the same when another camera is plugged in there
    std::uint16_t vendor = 0;
    std::uint16_t product = 0;
    std::uint16_t firmware = 0;  ///< bcdDevice
    std::string serial;          ///< of the USB descriptor
    double speed_mbit = 0;       ///< 480: USB 2; 5000 and more: USB 3
    int bus = 0;
    int address = 0;           ///< changes with every plugging
    bool autosuspend = false;  ///< the kernel may switch it off when it is idle

    const ZedCamera* zed() const { return zed_camera(vendor, product); }

    /// "ZED 2", or the name.
    std::string model() const;

    /// "ZED 2 (serial 12345, /dev/video0, USB port 2-1)"; `known_serial` counts when the descriptor has none.
    std::string label(const std::string& known_serial = {}) const;
};

/// Whether both are the same camera, not unplugged in between.
bool same_plugging(const UsbCamera& a, const UsbCamera& b);

/// Lists every video device by its first node, and ZED cameras without one. Folders that vanish meanwhile are left out.
std::vector<UsbCamera> list_cameras(const std::string& sys = "/sys", const std::string& dev = "/dev");

}  // namespace disparityd::capture
