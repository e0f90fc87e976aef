// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/camera/picture_controls.h"

#include <algorithm>

namespace simulated_camera {

ControlAnswer PictureControls::read(const Control& control, std::uint8_t request) {
    Bytes bytes;
    switch (request) {
        case uvc_request::get_cur: append_little_endian(bytes, control.now, control.length); break;
        case uvc_request::get_min: append_little_endian(bytes, control.lowest, control.length); break;
        case uvc_request::get_max: append_little_endian(bytes, control.highest, control.length); break;
        case uvc_request::get_res: append_little_endian(bytes, control.step, control.length); break;
        case uvc_request::get_def: append_little_endian(bytes, control.usual, control.length); break;
        case uvc_request::get_len: append_little_endian(bytes, control.length, 2); break;
        case uvc_request::get_info: bytes = {readable_and_writable}; break;
        default: return std::nullopt;
    }
    return bytes;
}

ControlAnswer PictureControls::answer(const SetupPacket& setup, std::span<const std::uint8_t> data) {
    const auto control = std::find_if(controls_.begin(), controls_.end(),
                                      [&](const Control& each) { return each.selector == setup.value_high(); });
    if (control == controls_.end()) {
        return std::nullopt;
    }
    if (setup.request != uvc_request::set_cur) {
        return read(*control, setup.request);
    }
    if (data.size() != control->length) {
        return std::nullopt;
    }
    const std::uint32_t value = get_little_endian(data, 0, control->length);
    control->now = static_cast<std::uint16_t>(std::clamp<std::uint32_t>(value, control->lowest, control->highest));
    return Bytes();
}

}  // namespace simulated_camera
