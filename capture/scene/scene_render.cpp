// SPDX-License-Identifier: Apache-2.0
#include "capture/scene/scene_render.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/calibration.h"
#include "capture/scene/scene_camera.h"
#include "capture/scene/scene_world.h"

namespace disparityd::capture {
namespace {

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

// Sensor noise: the sum of two dice, -2 .. 2 grey levels, the same for the same pixel of the same frame.
int sensor_noise(std::uint32_t pixel, std::uint32_t seed) {
    std::uint32_t h = (pixel * 0x9e3779b1U) ^ seed;
    h = (h ^ (h >> 15U)) * 0x2c1b3c6dU;
    h ^= h >> 12U;
    return static_cast<int>(h % 3U) + static_cast<int>((h >> 16U) % 3U) - 2;
}

std::uint8_t to_byte(double value) {
    return static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0) + 0.5);
}

}  // namespace

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

double scene_phase(const SceneOptions& options, std::uint64_t index) {
    const auto loop = static_cast<std::uint64_t>(options.loop);
    return static_cast<double>(index % loop) / static_cast<double>(loop);
}

SceneRenderer::SceneRenderer(const SceneOptions& options, const std::function<void()>& each_row)
    : options_(options), calibration_(scene_calibration(options.width, options.height)) {
    left_ = {pixel_rays(calibration_.left, options.width, options.height, each_row), calibration_.left.fx, 1.0,
             options.seed * 2654435761U + 17U};
    right_ = {pixel_rays(calibration_.right, options.width, options.height, each_row), calibration_.right.fx, 1.02,
              options.seed * 2654435761U + 9973U};
}

std::size_t SceneRenderer::frame_bytes() const {
    return static_cast<std::size_t>(options_.width) * static_cast<std::size_t>(options_.height) * 4;
}

void SceneRenderer::render(int index, std::uint8_t* yuyv, const std::function<void()>& each_row) const {
    render_eye(index, left_, false, yuyv, each_row);
    render_eye(index, right_, true, yuyv + 2 * static_cast<std::ptrdiff_t>(options_.width), each_row);
}

void SceneRenderer::render_eye(int index, const EyeView& view, bool right, std::uint8_t* yuyv,
                               const std::function<void()>& each_row) const {
    const SceneWorld world(scene_phase(options_, static_cast<std::uint64_t>(index)), options_.seed);
    const SceneEye eye(calibration_, right);
    const std::uint32_t noise_seed = view.noise_seed + static_cast<std::uint32_t>(index) * 0x632be5abU;
    const auto stride = 4 * static_cast<std::ptrdiff_t>(options_.width);
    for (int y = 0; y < options_.height; ++y) {
        each_row();
        std::uint8_t* row = yuyv + y * stride;
        for (int x = 0; x < options_.width; x += 2) {
            double u = 0;
            double v = 0;
            for (int k = 0; k < 2; ++k) {
                const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(options_.width) +
                                   static_cast<std::size_t>(x + k);
                const Ray ray = eye.ray(view.rays[pixel]);
                const SceneWorld::Hit hit = world.cast(ray);
                const SceneWorld::Colour colour = world.colour(ray, hit, hit.distance / view.focal);
                const int noise = sensor_noise(static_cast<std::uint32_t>(pixel), noise_seed);
                row[2 * (x + k)] = to_byte(view.gain * colour.luma + noise);
                u += 0.5 * colour.u;
                v += 0.5 * colour.v;
            }
            row[2 * x + 1] = to_byte(u);
            row[2 * x + 3] = to_byte(v);
        }
    }
}

}  // namespace disparityd::capture
