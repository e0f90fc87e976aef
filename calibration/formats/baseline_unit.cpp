// SPDX-License-Identifier: Apache-2.0
#include "calibration/formats/baseline_unit.h"

#include <cmath>
#include <cstdio>

#include "base/message_text.h"

namespace disparityd::calibration {

namespace {

constexpr double longest_mm = 2000;

double baseline_of(const StereoCalibration& calibration) {
    const auto& t = calibration.translation;
    return std::hypot(t[0], t[1], t[2]);
}

/// Returns a length with four digits.
std::string length_text(double length) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", length);
    return text;
}

std::string unit_name(double millimetres) {
    return millimetres == 1      ? "mm"
           : millimetres == 10   ? "cm"
           : millimetres == 1000 ? "m"
                                 : length_text(millimetres) + "mm";
}

}  // namespace

void scale_lengths(StereoCalibration& calibration, double factor) {
    for (double& length : calibration.translation) {
        length *= factor;
    }
    if (calibration.inertial.to_left_camera) {
        for (double& length : calibration.inertial.to_left_camera->translation) {
            length *= factor;
        }
    }
}

StereoCalibration settle_unit(FileCalibration read, std::optional<double> wanted_mm, const std::string& name) {
    if (wanted_mm) {
        scale_lengths(read.calibration, *wanted_mm / read.unit_mm);
        return read.calibration;
    }
    const double baseline = baseline_of(read.calibration);
    const bool usual = baseline >= read.least_baseline_mm && baseline <= longest_mm && read.unit_doubt.empty();
    if (read.unit_stated || baseline == 0 || usual) {
        return read.calibration;
    }
    const double number = baseline / read.unit_mm;
    const auto as = [&](double unit) {
        return "?unit=" + unit_name(unit) + " (" + length_text(number * unit) + " mm)";
    };
    constexpr double square = 25;
    const std::string why = read.unit_doubt.empty()
                                ? "taken without a unit is " + length_text(read.least_baseline_mm) +
                                      " mm to 2 m, as such a file may be in metres, in centimetres or in squares of "
                                      "the board"
                                : read.unit_doubt;
    refuse_calibration(
        name, "the baseline (the length of T) is " + length_text(number) + ", " + length_text(baseline) +
                  " mm if its unit is " + unit_name(read.unit_mm) + "; " + why +
                  ", and distances would be wrong by that factor: put the unit behind the name: " + as(1000) + ", " +
                  as(10) + ", " + as(1) + ", or the side of a square, such as " + as(square));
}

}  // namespace disparityd::calibration
