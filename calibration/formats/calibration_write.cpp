// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <span>
#include <stdexcept>

#include "base/number_text.h"
#include "calibration/calibration.h"
#include "calibration/lens.h"

namespace disparityd::calibration {

namespace {

void put_matrix(std::string& text, const char* name, int rows, std::span<const double> numbers) {
    const int columns = static_cast<int>(numbers.size()) / rows;
    text += std::string(name) + ": !!opencv-matrix\n   rows: " + std::to_string(rows) +
            "\n   cols: " + std::to_string(columns) + "\n   dt: d\n   data: [ ";
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        text += (i == 0 ? "" : i % 4 == 0 ? ",\n       " : ", ") + base::number_text(numbers[i]);
    }
    text += " ]\n";
}

void put_camera(std::string& text, const CameraModel& camera, const char* matrix, const char* distortion) {
    put_matrix(text, matrix, 3, std::array{camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0});
    put_matrix(text, distortion, 1, lens_coefficients(camera));
}

void put_inertial_nodes(std::string& text, const InertialCalibration& inertial) {
    if (inertial.to_left_camera) {
        const auto& [r, t] = *inertial.to_left_camera;
        put_matrix(
            text, "T_cam_imu", 4,
            std::array{r[0], r[1], r[2], t[0], r[3], r[4], r[5], t[1], r[6], r[7], r[8], t[2], 0.0, 0.0, 0.0, 1.0});
    }
    for (const auto& [key, member] : inertial_numbers) {
        if (inertial.*member) {
            text += std::string(key) + ": " + base::number_text(*(inertial.*member)) + "\n";
        }
    }
}

}  // namespace

std::string to_opencv_yaml(const StereoCalibration& calibration) {
    std::string text = "%YAML:1.0\n---\nimage_width: " + std::to_string(calibration.width) +
                       "\nimage_height: " + std::to_string(calibration.height) + "\nunit: mm\n";
    if (calibration.left.lens == LensModel::fisheye) {
        text += "distortion_model: equidistant\n";
    }
    put_camera(text, calibration.left, "M1", "D1");
    put_camera(text, calibration.right, "M2", "D2");
    put_matrix(text, "R", 3, calibration.rotation);
    put_matrix(text, "T", 3, calibration.translation);
    put_inertial_nodes(text, calibration.inertial);
    return text;
}

}  // namespace disparityd::calibration
