// SPDX-License-Identifier: Apache-2.0
#include "capture/source_condition.h"

namespace disparityd::capture {

const char* to_string(CameraState state) {
    switch (state) {
        case CameraState::starting: return "starting";
        case CameraState::streaming: return "streaming";
        case CameraState::absent: return "absent";
        case CameraState::stalled: return "stalled";
        case CameraState::busy: return "busy";
        case CameraState::no_permission: return "no-permission";
        case CameraState::old_firmware: return "old-firmware";
        case CameraState::usb2_link: return "usb2-link";
        case CameraState::mode_refused: return "mode-refused";
        case CameraState::no_calibration: return "no-calibration";
        case CameraState::changed: return "changed";
        case CameraState::failed: return "failed";
        case CameraState::unpaired: return "unpaired";
    }
    return "";
}

const char* to_string(SensorState state) {
    switch (state) {
        case SensorState::starting: return "starting";
        case SensorState::streaming: return "streaming";
        case SensorState::absent: return "absent";
        case SensorState::silent: return "silent";
        case SensorState::no_permission: return "no-permission";
        case SensorState::failed: return "failed";
    }
    return "";
}

}  // namespace disparityd::capture
