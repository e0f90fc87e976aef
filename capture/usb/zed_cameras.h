// SPDX-License-Identifier: Apache-2.0
//
// USB identities of ZED cameras. Facts of the cameras themselves, as their maker's published open capture library
// (zed-open-capture) names them too.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace disparityd::capture {

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

}  // namespace disparityd::capture
