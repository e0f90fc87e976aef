// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/camera_message.h"

#include "proto/text.h"

namespace disparityd::daemon {

v1::CameraStatus to_message(const capture::CameraFacts& camera) {
    v1::CameraStatus message;
    message.set_state(capture::to_string(camera.state));
    message.set_model(proto::to_valid_utf8(camera.model));
    message.set_serial(proto::to_valid_utf8(camera.serial));
    message.set_node(camera.node);
    message.set_port(camera.port);
    message.set_firmware(camera.firmware);
    message.set_speed_mbit(camera.speed_mbit);
    message.set_rate(camera.rate);
    message.set_arrivals(camera.arrivals);
    message.set_restarts(camera.restarts);
    message.set_reopens(camera.reopens);
    message.set_resets(camera.resets);
    message.set_damaged(camera.damaged);
    message.set_too_short(camera.too_short);
    message.set_unpaired(camera.unpaired);
    if (camera.apart) {
        message.mutable_eyes_apart()->set_median_us(static_cast<double>(camera.apart->median_ns) / 1e3);
        message.mutable_eyes_apart()->set_drift_ppm(camera.apart->drift * 1e6);
    }
    return message;
}

v1::CameraControls to_message(const std::vector<capture::CameraControl>& controls) {
    v1::CameraControls message;
    for (const capture::CameraControl& control : controls) {
        v1::CameraControl& to = *message.add_controls();
        to.set_name(proto::to_valid_utf8(control.name));
        to.set_value(control.value);
        to.set_min(control.min);
        to.set_max(control.max);
        to.set_default_(control.initial);
    }
    return message;
}

std::vector<capture::CameraSetting> to_settings(const v1::CameraRequest& request) {
    std::vector<capture::CameraSetting> settings;
    for (const v1::CameraSetting& setting : request.settings()) {
        settings.push_back({setting.name(), setting.value()});
    }
    return settings;
}

}  // namespace disparityd::daemon
