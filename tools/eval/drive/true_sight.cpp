// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/drive/true_sight.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "proto/doubt.h"

namespace disparityd::eval {
namespace {

/// The planes of one frame, and the scanner of all.
class PerfectDepth {
public:
    PerfectDepth(const Course& course, const CourseCamera& camera, const ScanSettings& settings)
        : course_(course),
          camera_(camera),
          scanner_(camera, settings.match.range, settings.scan),
          disparity_(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height)),
          confidence_(disparity_.size()) {}

    Seen see(const Pose& pose) {
        const std::vector<double> depth = draw_depth(course_, camera_at(camera_, pose));
        constexpr double largest = 32767;
        for (std::size_t i = 0; i < depth.size(); ++i) {
            const double sixteenths = 16 * camera_.f * camera_.baseline_m / depth[i];
            disparity_[i] = static_cast<std::int16_t>(std::lround(std::min(sixteenths, largest)));
            confidence_[i] = std::isfinite(depth[i]) ? 255 : 0;
        }
        FrameView view;
        view.disparity = {disparity_.data(), camera_.width, camera_.height, camera_.width};
        view.confidence = {confidence_.data(), camera_.width, camera_.height, camera_.width};
        constexpr std::uint32_t full_trust = 255;
        Serial serial;
        return {scanner_.scan(view, serial), full_trust << proto::trust_shift};
    }

private:
    Course course_;
    CourseCamera camera_;
    DriveScanner scanner_;
    std::vector<std::int16_t> disparity_;
    std::vector<std::uint8_t> confidence_;
};

}  // namespace

Sight true_sight(const Course& course, const CourseCamera& camera, const ScanSettings& settings) {
    const auto depth = std::make_shared<PerfectDepth>(course, camera, settings);
    return [depth](const Pose& pose) { return depth->see(pose); };
}

}  // namespace disparityd::eval
