// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/rendered_scene.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>

#include "calibration/rectification.h"
#include "capture/scene/scene_camera.h"
#include "capture/scene/scene_options.h"
#include "capture/scene/scene_render.h"
#include "kernels/reference/steps.h"

namespace disparityd::eval {
namespace {

constexpr std::uint64_t usual_frames = 8;

/// Draws frames of one URI. The rays of the camera are the same for all of them.
class RenderedFrames {
public:
    RenderedFrames(std::string uri, const capture::SceneOptions& options)
        : uri_(std::move(uri)),
          options_(options),
          renderer_(options),
          rectification_(calibration::make_rectification(capture::scene_calibration(options.width, options.height),
                                                         options.width, options.height, {})) {}

    Scene read(const std::string& name, int index) const {
        std::vector<std::uint8_t> yuyv(renderer_.frame_bytes());
        renderer_.render(index, yuyv.data(), [] {});
        const RawImage raw{yuyv.data(), PixelFormat::yuyv, options_.width, options_.height, 4L * options_.width};
        const Rectifier rectifier = rectification_.rectifier();
        Scene scene{name, rectified(raw, Eye::left, rectifier), rectified(raw, Eye::right, rectifier), {}, {}, {}, 0};
        capture::SceneTruth truth = capture::scene_truth(uri_, static_cast<std::uint64_t>(index), rectification_);
        for (float& disparity : truth.disparity) {
            disparity = std::isnan(disparity) ? std::numeric_limits<float>::infinity() : disparity;
        }
        scene.truth = {rectification_.width, rectification_.height, std::move(truth.disparity)};
        scene.non_occluded = std::move(truth.visible);
        scene.thin = std::move(truth.thin);
        scene.disparities = covering_disparities(scene.truth, 0);
        return scene;
    }

private:
    cv::Mat rectified(const RawImage& raw, Eye eye, const Rectifier& rectifier) const {
        cv::Mat image(rectification_.height, rectification_.width, CV_8UC1);
        const auto stride = static_cast<std::ptrdiff_t>(image.step);
        reference::rectify(raw, eye, rectifier, {image.data, image.cols, image.rows, stride}, {0, image.rows});
        return image;
    }

    std::string uri_;
    capture::SceneOptions options_;
    capture::SceneRenderer renderer_;
    calibration::Rectification rectification_;
};

}  // namespace

std::vector<SceneToJudge> rendered_scenes(const std::string& uri) {
    const capture::SceneOptions options = capture::parse_scene_uri(uri);
    // After a loop the same frames come again.
    const auto count = static_cast<int>(
        std::min<std::uint64_t>(options.frames.value_or(usual_frames), static_cast<std::uint64_t>(options.loop)));
    const auto frames = std::make_shared<const RenderedFrames>(uri, options);
    std::vector<SceneToJudge> scenes;
    for (int i = 0; i < count; ++i) {
        const int index = i * options.loop / count;
        const std::string name = uri + '#' + std::to_string(index);
        scenes.push_back({name, 0, [frames, name, index] { return frames->read(name, index); }});
    }
    return scenes;
}

}  // namespace disparityd::eval
