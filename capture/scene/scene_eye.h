// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibration/calibration.h"
#include "capture/scene/scene_camera.h"
#include "capture/scene/scene_world.h"

namespace disparityd::capture {

/// Where an eye of the imagined camera stands: from its own axes to the scene's, which are the left camera's.
class SceneEye {
public:
    SceneEye(const calibration::StereoCalibration& calibration, bool right) {
        if (right) {
            // x_right = R x_left + T, so the eye lies at -R^T T and its axes are the rows of R.
            const auto& r = calibration.rotation;
            const auto& t = calibration.translation;
            x_ = {r[0], r[1], r[2]};
            y_ = {r[3], r[4], r[5]};
            z_ = {r[6], r[7], r[8]};
            centre_ = (-t[0]) * x_ + ((-t[1]) * y_ + (-t[2]) * z_);
        }
    }

    Ray ray(RayDirection direction) const { return {centre_, z_ + (direction.x * x_ + direction.y * y_)}; }
    Vec3 centre() const { return centre_; }

private:
    Vec3 x_{1, 0, 0};
    Vec3 y_{0, 1, 0};
    Vec3 z_{0, 0, 1};
    Vec3 centre_;
};

}  // namespace disparityd::capture
