// SPDX-License-Identifier: Apache-2.0
#include "capture/scene/scene_camera.h"

#include <algorithm>
#include <array>

#include <opencv2/calib3d.hpp>

#include "base/number_text.h"
#include "calibration/zed_modes.h"

namespace disparityd::capture {

namespace {

// At HD720. The centre is an offset from the middle of the picture.
struct Eye {
    double fx, fy, centre_x, centre_y;
    std::array<double, 14> distortion;
};
constexpr Eye left_eye{701.25, 700.75, 6.5, -9.25, {-0.1715, 0.0268, 0.00021, -0.00034, 0}};
constexpr Eye right_eye{699.5, 699.25, -4.75, 8.5, {-0.1702, 0.0261, -0.00016, 0.00027, 0}};
constexpr double baseline_mm = 119.8;
constexpr double ty_mm = 0.21;
constexpr double tz_mm = -0.33;
constexpr double turn_x = 0.0041;  // rad
constexpr double turn_y = 0.0072;
constexpr double turn_z = -0.0013;

calibration::CameraModel camera_of(const Eye& eye, int width, int height, double scale) {
    return {eye.fx * scale, eye.fy * scale, 0.5 * width + eye.centre_x * scale, 0.5 * height + eye.centre_y * scale,
            eye.distortion};
}

void put_camera(std::string& text, const std::string& section, const calibration::CameraModel& camera) {
    text += "[" + section + "]\n";
    const auto put = [&](const char* key, double value) {
        text.append(key).append("=").append(base::number_text(value)).append("\n");
    };
    put("fx", camera.fx);
    put("fy", camera.fy);
    put("cx", camera.cx);
    put("cy", camera.cy);
    put("k1", camera.distortion[0]);
    put("k2", camera.distortion[1]);
    put("p1", camera.distortion[2]);
    put("p2", camera.distortion[3]);
    put("k3", camera.distortion[4]);
    text += "\n";
}

}  // namespace

calibration::StereoCalibration scene_calibration(int width, int height) {
    const calibration::ZedMode* mode = calibration::zed_mode_of_size(width, height);
    const double scale = mode != nullptr ? mode->focal_length : width / 1280.0;
    calibration::StereoCalibration calibration;
    calibration.width = width;
    calibration.height = height;
    calibration.origin = "scene";
    calibration.left = camera_of(left_eye, width, height, scale);
    calibration.right = camera_of(right_eye, width, height, scale);
    calibration.translation = {-baseline_mm, ty_mm, tz_mm};
    cv::Matx33d rotation;
    cv::Rodrigues(cv::Vec3d(turn_x, turn_y, turn_z), rotation);
    std::copy(rotation.val, rotation.val + 9, calibration.rotation.begin());
    return calibration;
}

std::string scene_calibration_conf() {
    std::string text;
    for (const calibration::ZedMode& mode : calibration::zed_modes) {
        const std::string section(mode.section);
        put_camera(text, "LEFT_CAM_" + section, camera_of(left_eye, mode.width, mode.height, mode.focal_length));
        put_camera(text, "RIGHT_CAM_" + section, camera_of(right_eye, mode.width, mode.height, mode.focal_length));
    }
    text += "[STEREO]\nBaseline=" + base::number_text(baseline_mm) + "\nTY=" + base::number_text(ty_mm) +
            "\nTZ=" + base::number_text(tz_mm) + "\n";
    for (const calibration::ZedMode& mode : calibration::zed_modes) {
        const std::string section(mode.section);
        text += "CV_" + section + "=" + base::number_text(turn_y) + "\nRX_" + section + "=" +
                base::number_text(turn_x) + "\nRZ_" + section + "=" + base::number_text(turn_z) + "\n";
    }
    return text;
}

std::vector<RayDirection> pixel_rays(const calibration::CameraModel& camera, int width, int height,
                                     const std::function<void()>& each_row) {
    constexpr int iterations = 20;  // of the fixed point; it gains about a digit each at a ZED's corners
    const auto& [k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4, tau_x, tau_y] = camera.distortion;
    std::vector<RayDirection> rays;
    rays.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (int v = 0; v < height; ++v) {
        if (each_row) {
            each_row();
        }
        for (int u = 0; u < width; ++u) {
            const double distorted_x = (u - camera.cx) / camera.fx;
            const double distorted_y = (v - camera.cy) / camera.fy;
            double x = distorted_x;
            double y = distorted_y;
            for (int i = 0; i < iterations; ++i) {
                const double r2 = x * x + y * y;
                const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
                const double dx = 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
                const double dy = p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
                x = (distorted_x - dx) / radial;
                y = (distorted_y - dy) / radial;
            }
            rays.push_back({static_cast<float>(x), static_cast<float>(y)});
        }
    }
    return rays;
}

}  // namespace disparityd::capture
