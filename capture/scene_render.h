// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "capture/calibration.h"
#include "capture/scene_camera.h"
#include "capture/scene_options.h"

namespace disparityd::capture {

/// Draws the scene as the imagined camera captures it: both eyes side by side, YUYV.
class SceneRenderer {
public:
    explicit SceneRenderer(const SceneOptions& options);

    std::size_t frame_bytes() const;

    /// Frame `index` of the loop. Any thread, several at once. `each_row` is called before every row; what it throws
    /// ends the drawing.
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
    StereoCalibration calibration_;
    EyeView left_;
    EyeView right_;
};

/// The moment of the loop that frame `index` shows, in [0, 1).
double scene_phase(const SceneOptions& options, std::uint64_t index);

}  // namespace disparityd::capture
