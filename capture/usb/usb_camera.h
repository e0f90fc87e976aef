// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace disparityd::capture {

// USB identities of ZED cameras. Facts of the cameras themselves, as their maker's published open capture library
// (zed-open-capture) names them too.
inline constexpr std::uint16_t zed_vendor = 0x2b03;

struct ZedCamera {
    std::uint16_t product;  ///< of the video (UVC) device
    std::uint16_t sensors;  ///< product of the sensor (HID) device; 0 = has none
    std::string_view model;
    bool old_firmware;  ///< enumerates, but gives no full video
};

inline constexpr std::array<ZedCamera, 6> zed_cameras{{{0xf580, 0, "ZED", true},
                                                       {0xf582, 0, "ZED", false},
                                                       {0xf680, 0xf681, "ZED Mini", true},
                                                       {0xf682, 0xf681, "ZED Mini", false},
                                                       {0xf780, 0xf781, "ZED 2", false},
                                                       {0xf880, 0xf881, "ZED 2i", false}}};

/// The row of a USB device, or nullptr.
constexpr const ZedCamera* zed_camera(std::uint16_t vendor, std::uint16_t product) {
    for (const ZedCamera& camera : zed_cameras) {
        if (vendor == zed_vendor && camera.product == product) {
            return &camera;
        }
    }
    return nullptr;
}

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
    std::string place{};       ///< the kernel's name of what the node belongs to: "2-1.4:1.0" where two share a port

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

/// Remembers since when each camera that is there is plugged in. One thread.
class PluggedCameras {
public:
    using Clock = std::chrono::steady_clock;

    /// Takes the cameras that are there now. Returns whether one has come, or come again, since the last call.
    bool note(const std::vector<UsbCamera>& cameras, Clock::time_point now);

    /// Returns when the camera was first noted in this plugging; the least time for one that was not.
    Clock::time_point since(const UsbCamera& camera) const;

private:
    struct Plugged {
        UsbCamera camera;
        Clock::time_point since;
    };

    std::vector<Plugged> plugged_;
};

}  // namespace disparityd::capture
