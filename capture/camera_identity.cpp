// SPDX-License-Identifier: Apache-2.0
#include "capture/camera_identity.h"

#include <cerrno>
#include <stdexcept>

#include "capture/camera_calibration.h"
#include "capture/zed_extension.h"

namespace disparityd::capture {

std::optional<CameraTrouble> CameraIdentity::identify(UsbCamera& camera) {
    if (camera.zed() == nullptr || camera.node.empty() || camera.zed()->old_firmware) {
        return std::nullopt;
    }
    if (asked_ && same_plugging(*asked_, camera)) {
        camera.serial = asked_->serial;
        return std::nullopt;
    }
    const ZedSerial answer = read_zed_serial(system_, camera.node);
    if (!answer.text.empty()) {
        camera.serial = answer.text;
        asked_ = camera;
        return std::nullopt;
    }
    const bool not_needed = request_.serial.empty() || camera.serial == request_.serial;
    const bool refused = answer.code == EACCES || answer.code == EPERM || answer.code == EBUSY;
    if (not_needed || !refused) {
        return std::nullopt;
    }
    return trouble_of(VideoError(VideoError::Call::open, answer.code, camera.node), camera, camera.label());
}

std::optional<StereoCalibration> CameraIdentity::likely_calibration() {
    std::string serial = request_.serial;
    if (serial.empty()) {
        std::vector<UsbCamera> cameras = candidates(system_.cameras(), request_);
        if (cameras.empty()) {
            return std::nullopt;
        }
        identify(cameras.front());
        serial = cameras.front().serial;
    }
    try {
        return find_camera_calibration(serial, options_.calibration_folders, request_.eye_width(),
                                       request_.eye_height());
    } catch (const std::invalid_argument&) {
        return std::nullopt;
    }
}

std::optional<CameraTrouble> CameraIdentity::check_calibration(const UsbCamera& camera,
                                                               const std::optional<StereoCalibration>& in_use) const {
    if (!options_.calibration_path.empty()) {
        return std::nullopt;
    }
    std::optional<StereoCalibration> found;
    try {
        found = find_camera_calibration(camera.serial, options_.calibration_folders, request_.eye_width(),
                                        request_.eye_height());
    } catch (const std::invalid_argument& error) {
        return CameraTrouble{CameraState::no_calibration, error.what()};
    }
    if (!found && !options_.allow_unrectified) {
        return no_calibration_trouble(camera, options_.calibration_folders);
    }
    const auto text = [](const std::optional<StereoCalibration>& c) { return c ? to_text(*c) : std::string(); };
    if (text(found) == text(in_use)) {
        return std::nullopt;
    }
    return CameraTrouble{CameraState::changed, camera.label() + " has another calibration than the camera before: " +
                                                   (found ? found->origin : "none") + "; it is put to use"};
}

}  // namespace disparityd::capture
