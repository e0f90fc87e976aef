// SPDX-License-Identifier: Apache-2.0
#include "calibration/formats/lens_model.h"

#include <algorithm>
#include <cmath>

#include "base/message_text.h"
#include "base/number_text.h"
#include "base/words.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/lens.h"

namespace disparityd::calibration {

namespace {

bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

bool all_zero(const std::vector<double>& numbers) {
    return std::all_of(numbers.begin(), numbers.end(), [](double number) { return number == 0; });
}

}  // namespace

void set_lens(CameraModel& camera, const std::string& path, const std::string& key,
              const std::vector<double>& coefficients, LensModel lens) {
    std::vector<double> numbers = all_zero(coefficients) ? std::vector<double>(4) : coefficients;
    const bool fisheye = lens == LensModel::fisheye;
    if (!fisheye && numbers.size() == 4) {
        numbers.push_back(0);  // k3
    }
    if ((fisheye && numbers.size() != 4) || !set_lens_coefficients(camera, numbers)) {
        refuse_calibration(path, key + ": found " + base::counted(coefficients.size(), "distortion coefficient") +
                                     (fisheye ? ", expected the 4 of a fisheye lens (k1 to k4)"
                                              : ", allowed are 4 or 5 (k1 k2 p1 p2 k3), 8 (rational: k4 k5 k6), 12 "
                                                "(thin prism: s1 to s4) and 14 (tilted sensor: tau x, tau y)"));
    }
}

void refuse_fisheye(const std::string& path, const std::string& key, const std::string& found) {
    refuse_calibration(path, key + ": found " + found +
                                 ": this looks like the fisheye model (equidistant, k1 to k4), and the file does not "
                                 "say so in a way that is known: write both cameras as M1, D1, M2, D2, R and T with "
                                 "'distortion_model: equidistant' into an OpenCV YAML");
}

LensModel named_lens(const std::string& path, const std::string& key, std::string_view name) {
    const std::string plain = plain_name(name);
    if (is_one_of(plain, {"pinhole", "plumbbob", "radtan", "radialtangential", "brown", "brownconrady", "opencv",
                          "perspective", "none", "rational", "rationalpolynomial", "pinholeradtan", "standard"})) {
        return LensModel::pinhole;
    }
    if (is_one_of(plain, {"fisheye", "equidistant", "equi", "kannalabrandt", "kannalabrandt8", "kannalabrandt4", "kb4",
                          "kb8", "opencvfisheye", "pinholeequi"})) {
        return LensModel::fisheye;
    }
    refuse_calibration(path, key + ": found '" + base::printable(name) +
                                 "', a lens model that is not known; allowed are plumb_bob, radtan, brown, pinhole, "
                                 "rational_polynomial and equidistant: calibrate with one of them, as disparityctl "
                                 "calibrate does");
}

CameraModel camera_of_matrix(const std::string& path, const std::string& key, const std::vector<double>& matrix) {
    if (matrix.size() != 9) {
        refuse_calibration(path, key + ": found " + base::counted(matrix.size(), "number") + ", expected 9: 3x3");
    }
    // So little moves no pixel by more than a hundredth.
    constexpr double negligible = 0.01;
    if (!(std::abs(matrix[1]) <= negligible)) {
        refuse_calibration(path, key + ": found a skew of " + base::number_text(matrix[1]) +
                                     " px (row 1, column 2), which is not applied; allowed is 0: calibrate without "
                                     "skew");
    }
    if (matrix[3] != 0 || matrix[6] != 0 || matrix[7] != 0 || matrix[8] != 1) {
        refuse_calibration(path, key + ": is no camera matrix; expected are fx 0 cx, 0 fy cy, 0 0 1");
    }
    return {matrix[0], matrix[4], matrix[2], matrix[5], {}};
}

std::string plain_name(std::string_view name) {
    std::string plain = base::lower_case(name);
    std::erase_if(plain, [](char c) { return c == ' ' || c == '-' || c == '_' || c == '.'; });
    return plain;
}

}  // namespace disparityd::calibration
