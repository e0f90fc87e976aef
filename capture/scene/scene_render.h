// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "calibration/calibration.h"
#include "capture/scene/scene_camera.h"
#include "capture/scene/scene_options.h"

namespace disparityd::capture {

/// Draws the scene as the imagined camera captures it: both eyes side by side, YUYV.
class SceneRenderer {
public:
    /// Computes the rays of both eyes: a while for a large picture. `each_row` may be empty; it is called before every
    /// row of each eye, and what it throws ends the work and passes through.
    explicit SceneRenderer(const SceneOptions& options, const std::function<void()>& each_row = {});

    std::size_t frame_bytes() const;

    /// Frame `index` of the loop. Any thread, several at once. `each_row` is called before every row of each eye, left
    /// first; what it throws ends the drawing and passes through, and that row and the ones after it stay as they were.
    void render(int index, std::uint8_t* yuyv, const std::function<void()>& each_row) const;

private:
    struct EyeView {
        std::vector<RayDirection> rays;
        double focal = 0;
        double gain = 1;
        std::uint32_t noise_seed = 0;
    };
    void render_eye(int index, const EyeView& view, bool right, std::uint8_t* yuyv,
                    const std::function<void()>& each_row) const;

    SceneOptions options_;
    calibration::StereoCalibration calibration_;
    EyeView left_;
    EyeView right_;
};

/// The moment of the loop that frame `index` shows, in [0, 1).
double scene_phase(const SceneOptions& options, std::uint64_t index);

}  // namespace disparityd::capture
