// SPDX-License-Identifier: Apache-2.0
#include "capture/scene/scene_truth.h"

#include <cmath>
#include <limits>

#include "capture/scene/scene_eye.h"
#include "capture/scene/scene_render.h"

namespace disparityd::capture {

SceneTruth scene_truth(const std::string& uri, std::uint64_t sequence,
                       const calibration::Rectification& rectification) {
    const SceneOptions options = parse_scene_uri(uri);
    const SceneWorld world(scene_phase(options, sequence), options.seed);
    const SceneEye right(scene_calibration(options.width, options.height), true);

    // Rows of R1 are the rectified axes in the left camera's: x_rectified = R1 x_left.
    const auto& r = rectification.left_rotation;
    const Vec3 axis_x{r[0], r[1], r[2]};
    const Vec3 axis_y{r[3], r[4], r[5]};
    const Vec3 axis_z{r[6], r[7], r[8]};

    SceneTruth truth;
    for (int y = 0; y < rectification.height; ++y) {
        for (int x = 0; x < rectification.width; ++x) {
            const double u = (x - rectification.cx) / rectification.f;
            const double v = (y - rectification.cy) / rectification.f;
            const Ray ray{{}, axis_z + (u * axis_x + v * axis_y)};
            const SceneWorld::Hit hit = world.cast(ray);
            if (hit.object < 0) {
                truth.disparity.push_back(std::numeric_limits<float>::quiet_NaN());
                truth.visible.push_back(0);
                truth.thin.push_back(0);
                continue;
            }
            // The ray has depth 1 per length of its direction.
            truth.disparity.push_back(static_cast<float>(rectification.f * rectification.baseline_mm / hit.distance));
            truth.thin.push_back(world.is_rod(hit) ? 1 : 0);
            const Vec3 point = hit.distance * ray.direction;
            const SceneWorld::Hit seen = world.cast({right.centre(), point - right.centre()});
            constexpr double tolerance = 1e-4;
            truth.visible.push_back(seen.object == hit.object && std::abs(seen.distance - 1) < tolerance ? 1 : 0);
        }
    }
    return truth;
}

}  // namespace disparityd::capture
