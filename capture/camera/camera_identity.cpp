// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/camera_identity.h"

#include <algorithm>
#include <cerrno>
#include <stdexcept>

#include "calibration/calibration_lookup.h"
#include "capture/camera/zed_extension.h"

namespace disparityd::capture {

SourceInfo info_of_camera(const CameraRequest& request, const SourceOptions& options) {
    SourceInfo info;
    info.name = options.uri;
    info.eye_width = request.eye_width();
    info.height = request.eye_height();
    info.format = request.format();
    info.rate = request.rate;
    info.live = true;
    info.description =
        request.wanted() + ", " + std::to_string(info.eye_width) + "x" + std::to_string(info.height) + " per eye";
    return info;
}

std::string pair_serial(const std::string& left, const std::string& right) {
    return left.empty() || right.empty() || left == right ? "" : left + "-" + right;
}

std::optional<CameraProblem> CameraIdentity::identify(UsbCamera& camera) {
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
    const bool refused = answer.code == EACCES || answer.code == EPERM || answer.code == EBUSY;
    if (!refused || camera.serial == request_.serial) {
        return std::nullopt;
    }
    return diagnose(VideoError(VideoError::Call::open, answer.code, camera.node), camera, camera.label());
}

std::string CameraIdentity::likely_serial(const std::string& port) {
    if (!request_.serial.empty()) {
        return request_.serial;
    }
    std::vector<UsbCamera> cameras = candidates(system_.cameras(), request_);
    if (cameras.empty()) {
        return "";
    }
    auto likely = std::find_if(cameras.begin(), cameras.end(), [&port](const UsbCamera& camera) {
        return !camera.port.empty() && camera.port == port;
    });
    likely = likely == cameras.end() ? cameras.begin() : likely;
    identify(*likely);
    return likely->serial;
}

std::optional<calibration::StereoCalibration> CameraIdentity::calibration_of(const std::string& serial) const {
    return calibration::find_camera_calibration(serial, options_.calibration_folders, request_.eye_width(),
                                                request_.eye_height());
}

void CameraIdentity::expect_likely(SourceInfo& info, const std::string& port) {
    expect(info, likely_serial(port));
}

void CameraIdentity::expect(SourceInfo& info, const std::string& serial) const {
    if (!options_.calibration_path.empty()) {
        info.calibration = calibration::read_calibration(options_.calibration_path, info.eye_width, info.height);
    } else {
        try {
            info.calibration = calibration_of(serial);
        } catch (const std::invalid_argument&) {
            info.calibration.reset();
        }
    }
    info.serial = info.calibration ? serial : "";
}

std::optional<CameraProblem> CameraIdentity::check_calibration(const UsbCamera& camera,
                                                               const SourceInfo& in_use) const {
    if (options_.calibration_path.empty()) {
        std::optional<calibration::StereoCalibration> found;
        try {
            found = calibration_of(camera.serial);
        } catch (const std::invalid_argument& error) {
            return CameraProblem{CameraState::no_calibration, error.what()};
        }
        if (!found && !options_.allow_unrectified) {
            return no_calibration_problem(camera, options_.calibration_folders);
        }
        const auto text = [](const std::optional<calibration::StereoCalibration>& c) {
            return c ? calibration::to_text(*c) : std::string();
        };
        if (text(found) != text(in_use.calibration)) {
            return CameraProblem{CameraState::changed,
                                 camera.label() + " has another calibration than the camera before: " +
                                     (found ? found->origin : "none") + "; the source is opened anew"};
        }
    }
    // What was learned about one camera, such as the correction of its calibration, does not hold for another.
    if (in_use.calibration && camera.serial != in_use.serial) {
        return CameraProblem{CameraState::changed,
                             camera.label() + " is not the camera " +
                                 (in_use.serial.empty() ? "that was expected" : "with serial " + in_use.serial) +
                                 "; the source is opened anew for it"};
    }
    return std::nullopt;
}

}  // namespace disparityd::capture
