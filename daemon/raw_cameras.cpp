// SPDX-License-Identifier: Apache-2.0
#include "daemon/raw_cameras.h"

#include <algorithm>
#include <initializer_list>

namespace disparityd::daemon {
namespace {

/// Returns how many coefficients people expect of it: as few as hold all that are not 0.
std::size_t coefficients_of(const calibration::CameraModel& camera) {
    if (camera.lens == calibration::LensModel::fisheye) {
        return 4;
    }
    const auto& all = camera.distortion;
    for (const std::size_t count : {5U, 8U, 12U}) {
        if (std::all_of(all.begin() + static_cast<std::ptrdiff_t>(count), all.end(), [](double k) { return k == 0; })) {
            return count;
        }
    }
    return all.size();
}

v1::RawCamera to_message(const calibration::CameraModel& camera, const std::array<double, 9>& turn) {
    v1::RawCamera message;
    message.set_fx(camera.fx);
    message.set_fy(camera.fy);
    message.set_cx(camera.cx);
    message.set_cy(camera.cy);
    message.set_lens(camera.lens == calibration::LensModel::fisheye ? "fisheye" : "pinhole");
    message.mutable_distortion()->Add(camera.distortion.begin(),
                                      camera.distortion.begin() + static_cast<std::ptrdiff_t>(coefficients_of(camera)));
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
