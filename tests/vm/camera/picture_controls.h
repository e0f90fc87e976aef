// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "tests/vm/camera/usb_request.h"

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

}  // namespace simulated_camera
