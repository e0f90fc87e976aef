// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

namespace disparityd::calibration {

/// A capture mode of a ZED camera.
struct ZedMode {
    std::string_view name;     ///< as users say it, lower case
    std::string_view section;  ///< how the sections and keys of a factory calibration end
    int width;                 ///< one eye, pixels
    int height;
    int highest_rate;     ///< frames per second
    double focal_length;  ///< against that of HD720; HD1080 is cut out of HD2K
};

inline constexpr std::array<ZedMode, 4> zed_modes{{{"hd2k", "2K", 2208, 1242, 15, 2},
                                                   {"hd1080", "FHD", 1920, 1080, 30, 2},
                                                   {"hd720", "HD", 1280, 720, 60, 1},
                                                   {"vga", "VGA", 672, 376, 100, 0.5}}};

/// Returns the mode whose eyes have this size, or nullptr.
constexpr const ZedMode* zed_mode_of_size(int width, int height) {
    for (const ZedMode& mode : zed_modes) {
        if (mode.width == width && mode.height == height) {
            return &mode;
        }
    }
    return nullptr;
}

/// Returns the mode of this name, in lower case, or nullptr.
constexpr const ZedMode* zed_mode_of_name(std::string_view name) {
    for (const ZedMode& mode : zed_modes) {
        if (mode.name == name) {
            return &mode;
        }
    }
    return nullptr;
}

}  // namespace disparityd::calibration
