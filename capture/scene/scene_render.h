// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "calibration/calibration.h"
#include "calibration/rectification.h"
#include "capture/scene/scene_camera.h"
#include "capture/scene/scene_options.h"

namespace disparityd::capture {

/// Exact ground truth of one frame, for each pixel of the rectified left image, row by row.
struct SceneTruth {
    std::vector<float> disparity;       ///< px; NaN where nothing is seen
    std::vector<std::uint8_t> visible;  ///< 1 where the right eye sees the same point
    std::vector<std::uint8_t> thin;     ///< 1 on a pole or a wire
};

/// Casts the rays of the rectified left camera into the scene at frame `sequence` of the source `uri` ("scene:...").
/// `rectification` must have been made from the scene's own calibration. Throws as open_source() does for a bad URI.
SceneTruth scene_truth(const std::string& uri, std::uint64_t sequence, const calibration::Rectification& rectification);

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
