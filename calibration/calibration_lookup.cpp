// SPDX-License-Identifier: Apache-2.0
#include "calibration/calibration_lookup.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "base/file_kind.h"
#include "base/number_text.h"
#include "base/words.h"

namespace disparityd::calibration {

namespace {

void check_at_most(double value, double most, const std::string& what, const StereoCalibration& calibration) {
    if (!(value <= most)) {
        throw std::invalid_argument("calibration " + calibration.origin + ": " + what + ": found " +
                                    base::number_text(value) + ", allowed is 0 to " + base::number_text(most) +
                                    ": this cannot be the calibration of this camera");
    }
}

/// Returns whether a serial number can be part of a file name.
bool is_plain(const std::string& serial) {
    return !serial.empty() && std::all_of(serial.begin(), serial.end(), [](unsigned char c) {
        return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '_';
    });
}

}  // namespace

std::vector<std::string> folder_list(const std::string& text) {
    std::vector<std::string> list;
    for (const std::string_view name : base::split(text, ':')) {
        if (!name.empty()) {
            list.emplace_back(name);
        }
    }
    return list;
}

void check_camera_plausible(const StereoCalibration& calibration) {
    const auto& r = calibration.rotation;
    const double cosine = std::clamp((r[0] + r[4] + r[8] - 1) / 2, -1.0, 1.0);
    check_at_most(std::acos(cosine), 0.2, "angle between the eyes in radians", calibration);
    if (calibration.left.fx > 0 && calibration.right.fx > 0) {
        const double ratio = calibration.left.fx / calibration.right.fx;
        check_at_most(std::abs(ratio - 1), 0.1, "difference of the focal lengths", calibration);
    }
    const auto& t = calibration.translation;
    if (t[0] != 0) {
        check_at_most(std::abs(t[1] / t[0]), 0.2, "height between the eyes against the baseline", calibration);
        check_at_most(std::abs(t[2] / t[0]), 0.2, "depth between the eyes against the baseline", calibration);
    }
}

std::optional<StereoCalibration> find_camera_calibration(const std::string& serial,
                                                         const std::vector<std::string>& folders, int eye_width,
                                                         int height) {
    if (!is_plain(serial)) {
        return std::nullopt;
    }
    for (const std::string& folder : folders) {
        for (const std::string& name : {"SN" + serial + ".conf", serial + ".yaml", serial + ".yml", serial + ".xml",
                                        "zed_calibration_" + serial + ".yml"}) {
            const auto path = std::filesystem::path(folder) / name;
            if (base::is_file(path)) {
                StereoCalibration calibration = read_calibration(path.string(), eye_width, height);
                check_camera_plausible(calibration);
                return calibration;
            }
        }
    }
    return std::nullopt;
}

}  // namespace disparityd::calibration
