// SPDX-License-Identifier: Apache-2.0
#include "calibration/formats/lens_model.h"

#include <algorithm>
#include <cmath>

#include "base/message_text.h"
#include "base/number_text.h"
#include "base/words.h"
#include "calibration/formats/calibration_formats.h"

namespace disparityd::calibration {

namespace {

constexpr const char* lens_advice =
    "; allowed is the Brown model (k1 k2 p1 p2 k3): calibrate with it, as disparityctl calibrate does";

bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

bool all_zero(const std::vector<double>& numbers) {
    return std::all_of(numbers.begin(), numbers.end(), [](double number) { return number == 0; });
}

const char* model_of_coefficient(std::size_t index) {
    return index < 8    ? "the rational model (k4 k5 k6)"
           : index < 12 ? "the thin prism model (s1 to s4)"
                        : "the model of a tilted sensor (tau x, tau y)";
}

}  // namespace

std::array<double, 5> brown_coefficients(const std::string& path, const std::string& key,
                                         const std::vector<double>& coefficients) {
    const std::size_t count = coefficients.size();
    const bool known = count == 4 || count == 5 || count == 8 || count == 12 || count == 14;
    if (!known && !all_zero(coefficients)) {
        refuse_calibration(path, key + ": found " + base::counted(count, "distortion coefficient") +
                                     ", allowed are 4 or 5 (k1 k2 p1 p2 k3), and 8, 12 or 14 where those beyond the "
                                     "fifth are 0");
    }
    std::array<double, 5> brown{};
    for (std::size_t i = 0; i < count; ++i) {
        if (i < brown.size()) {
            brown[i] = coefficients[i];
        } else if (coefficients[i] != 0) {
            refuse_calibration(path, key + ": found " + base::number_text(coefficients[i]) + " as coefficient " +
                                         std::to_string(i + 1) + " of " + std::to_string(count) + ": this is " +
                                         model_of_coefficient(i) + ", which is not applied" + lens_advice);
        }
    }
    return brown;
}

void refuse_fisheye(const std::string& path, const std::string& key, const std::string& found) {
    refuse_calibration(path, key + ": found " + found +
                                 ": this is the fisheye model (equidistant, Kannala-Brandt, k1 to k4), which is not "
                                 "applied" +
                                 lens_advice);
}

void check_lens_model(const std::string& path, const std::string& key, std::string_view name) {
    const std::string plain = plain_name(name);
    if (is_one_of(plain, {"pinhole", "plumbbob", "radtan", "radialtangential", "brown", "brownconrady", "opencv",
                          "perspective", "none", "rationalpolynomial", "pinholeradtan", "standard"})) {
        return;
    }
    if (is_one_of(plain, {"fisheye", "equidistant", "equi", "kannalabrandt", "kannalabrandt8", "kannalabrandt4", "kb4",
                          "kb8", "opencvfisheye", "pinholeequi"})) {
        refuse_fisheye(path, key, "'" + base::printable(name) + "'");
    }
    refuse_calibration(path, key + ": found '" + base::printable(name) +
                                 "', a lens model that is not known; allowed are plumb_bob, radtan, brown and pinhole" +
                                 lens_advice);
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
