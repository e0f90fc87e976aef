// SPDX-License-Identifier: Apache-2.0
#include "daemon/raw_cameras.h"

#include <vector>

#include "calibration/lens.h"

namespace disparityd::daemon {
namespace {

v1::RawCamera to_message(const calibration::CameraModel& camera, const std::array<double, 9>& turn) {
    v1::RawCamera message;
    message.set_fx(camera.fx);
    message.set_fy(camera.fy);
    message.set_cx(camera.cx);
    message.set_cy(camera.cy);
    message.set_lens(camera.lens == calibration::LensModel::fisheye ? "fisheye" : "pinhole");
    const std::vector<double> coefficients = calibration::lens_coefficients(camera);
    message.mutable_distortion()->Add(coefficients.begin(), coefficients.end());
    message.mutable_rotation()->Add(turn.begin(), turn.end());
    return message;
}

}  // namespace

std::optional<v1::RawCameras> raw_cameras(const calibration::StereoCalibration& calibration, const Turns& turns) {
    if (calibration.rectified) {
        return std::nullopt;
    }
    v1::RawCameras message;
    message.set_width(static_cast<std::uint32_t>(calibration.width));
    message.set_height(static_cast<std::uint32_t>(calibration.height));
    *message.mutable_left() = to_message(calibration.left, turns.left);
    *message.mutable_right() = to_message(calibration.right, turns.right);
    return message;
}

}  // namespace disparityd::daemon
