// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>

#include <opencv2/core/matx.hpp>

#include "base/message_text.h"
#include "base/number_text.h"
#include "base/words.h"
#include "calibration/formats/baseline_unit.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/formats/calibration_name.h"
#include "calibration/formats/lens_model.h"
#include "calibration/formats/opencv_keys.h"
#include "calibration/formats/opencv_storage.h"
#include "calibration/rotation.h"

namespace disparityd::calibration {

namespace {

using Matrix = OpencvStorage::Matrix;
using Keys = std::span<const std::string_view>;

constexpr const char* what_is_needed =
    "M1, D1, M2, D2, R and T are needed (or K_LEFT, D_LEFT, K_RIGHT, D_RIGHT, R and T), in one file or as "
    "intrinsics.yml,extrinsics.yml";

/// The entries of one file.
class CalibrationFile {
public:
    explicit CalibrationFile(const CalibrationText& file) : path_(file.path), storage_(file.path, file.text) {}

    /// Takes over the entries of a second file. What both state must be the same.
    void add(const CalibrationFile& other) {
        for (const std::string& name : storage_.add(other.storage_)) {
            if (!is_harmless_key(name)) {
                fail(base::printable(name) + ": found " + storage_.shown(name) + " and " + other.storage_.shown(name) +
                     " that differ in the two files, expected it once: take the wrong one out");
            }
        }
        path_ += "," + other.path_;
    }

    /// A matrix and the name that the file gives it.
    struct Named {
        std::string name;
        Matrix matrix;
    };

    /// Returns the matrix under any of these keys; `usual` is what a message calls it.
    Named matrix(Keys keys, const std::string& usual) const {
        Named result;
        for (const std::string& name : storage_.names()) {
            if (!is_among(name, keys)) {
                continue;
            }
            Matrix matrix = *storage_.matrix(name);
            if (!result.name.empty() && result.matrix.numbers != matrix.numbers) {
                storage_.fail(base::printable(result.name) + " and " + base::printable(name) +
                              " are two names of the same matrix with different numbers: take the wrong one out");
            }
            result = {name, std::move(matrix)};
        }
        if (result.name.empty()) {
            storage_.fail("has no matrix " + usual + "; " + what_is_needed);
        }
        return result;
    }

    bool has(Keys keys) const {
        const auto names = storage_.names();
        return std::any_of(names.begin(), names.end(), [&](const auto& name) { return is_among(name, keys); });
    }

    /// Refuses every entry that is neither used nor known to say nothing about the geometry.
    void check_keys() const {
        for (const std::string& name : storage_.names()) {
            const bool used = is_among(name, left_eye_keys.matrix) || is_among(name, left_eye_keys.distortion) ||
                              is_among(name, right_eye_keys.matrix) || is_among(name, right_eye_keys.distortion) ||
                              is_among(name, rotation_keys) || is_among(name, translation_keys) ||
                              is_among(name, unit_keys) || is_inertial_key(name) || is_size_key(name) ||
                              plain_name(name) == "baseline" || rectification_result(name);
            if (is_among(name, model_keys)) {
                named_lens(path_, base::printable(name), storage_.word(name));
            } else if (says_fisheye(name)) {
                const auto numbers = storage_.numbers(name);
                if (numbers != std::vector<double>{0} && numbers != std::vector<double>{1}) {
                    refuse_fisheye(path_, base::printable(name), storage_.shown(name));
                }
            } else if (is_map_key(name)) {
                storage_.fail(
                    base::printable(name) + ": found " + storage_.shown(name) +
                    ", which says how pixels move and would not be applied, as that follows from the cameras "
                    "and their pose: take it out, and give M1, D1, M2, D2, R and T where the file lacks them");
            } else if (!used && !is_harmless_key(name)) {
                storage_.fail("has the key '" + base::printable(name) + "' (" + storage_.shown(name) +
                              "), which is not known and would not be applied; " + what_is_needed +
                              ": take it out if it says nothing about lenses, sizes or units");
            }
        }
    }

    /// Returns the lens model that the file names.
    std::optional<LensModel> lens() const {
        std::optional<LensModel> lens;
        for (const std::string& name : storage_.names()) {
            if (is_among(name, model_keys)) {
                const LensModel named = named_lens(path_, base::printable(name), storage_.word(name));
                lens = lens == LensModel::fisheye ? lens : named;
            } else if (says_fisheye(name) && storage_.numbers(name) == std::vector<double>{1}) {
                lens = LensModel::fisheye;
            }
        }
        return lens;
    }

    bool check_size(int width, int height) const { return check_sizes(storage_, path_, width, height); }

    std::optional<double> unit_mm() const {
        for (const std::string& name : storage_.names()) {
            if (is_among(name, unit_keys)) {
                const auto unit = millimetres_of_unit(storage_.word(name));
                if (!unit) {
                    storage_.fail(base::printable(name) + ": found " + storage_.shown(name) +
                                  ", allowed are mm, cm, m, or the side of the board's squares, such as 25mm");
                }
                return unit;
            }
        }
        return std::nullopt;
    }

    /// Says why T is not in mm where the side of the board's squares cannot be: both have one unit.
    std::string unit_doubt() const {
        constexpr double smallest_square_mm = 2;
        for (const std::string& name : storage_.names()) {
            const auto side = plain_name(name) == "squaresize" ? storage_.numbers(name) : std::nullopt;
            if (side && side->size() == 1 && side->front() < smallest_square_mm) {
                return base::printable(name) + " is " + base::number_text(side->front()) +
                       " there, which is no length in mm, and T is in the same unit";
            }
        }
        return {};
    }

    /// Reads what the file says about the inertial sensor; lengths in the unit of the file.
    InertialCalibration inertial() const {
        InertialCalibration inertial;
        if (const auto matrix = storage_.matrix(pose_key)) {
            const std::vector<double>& rows = matrix->numbers;
            if (rows.size() != 16 || matrix->rows != 4 ||
                !std::equal(rows.begin() + 12, rows.end(), last_row.begin())) {
                fail(
                    "T_cam_imu: expected a matrix of 4x4 with a rotation, a translation in the unit of T, and 0 0 0 1 "
                    "below");
            }
            inertial.to_left_camera = pose_of_rows(rows);
        }
        for (const auto& [key, member] : inertial_numbers) {
            const std::string name(key);
            if (storage_.has(name)) {
                const auto numbers = storage_.numbers(name);
                if (!numbers || numbers->size() != 1) {
                    fail(name + ": found " + storage_.shown(name) + ", expected a number");
                }
                inertial.*member = numbers->front();
            }
        }
        return inertial;
    }

    /// Compares T with a baseline that the file states beside it.
    void check_baseline(const std::array<double, 3>& t) const {
        for (const std::string& name : storage_.names()) {
            const auto stated = plain_name(name) == "baseline" ? storage_.numbers(name) : std::nullopt;
            const double length = std::hypot(t[0], t[1], t[2]);
            if (stated && (stated->size() != 1 || !(std::abs(std::abs(stated->front()) - length) <= 0.01 * length))) {
                storage_.fail(base::printable(name) + ": found " + storage_.shown(name) + ", and T is " +
                              base::number_text(length) + " long: they contradict each other; take the wrong one out");
            }
        }
    }

    /// Adds what the file says about rectification beside cameras and pose.
    void add_results(std::vector<GivenResult>& given) const {
        for (const std::string& name : storage_.names()) {
            if (const auto what = rectification_result(name)) {
                Matrix matrix = *storage_.matrix(name);
                given.push_back(
                    {*what, path_, base::printable(name), matrix.rows, matrix.columns, std::move(matrix.numbers)});
            }
        }
    }

    const std::string& path() const { return path_; }
    [[noreturn]] void fail(const std::string& what) const { storage_.fail(what); }

private:
    static constexpr const char* pose_key = "T_cam_imu";
    static constexpr std::array<double, 4> last_row{0, 0, 0, 1};

    static bool is_inertial_key(const std::string& name) {
        return name == pose_key || std::any_of(inertial_numbers.begin(), inertial_numbers.end(),
                                               [&](const InertialNumber& number) { return name == number.key; });
    }
    static bool says_fisheye(const std::string& name) {
        return plain_name(name).find("fisheye") != std::string::npos || plain_name(name).ends_with("fe");
    }

    std::string path_;
    OpencvStorage storage_;
};

std::string size_text(const Matrix& matrix) {
    return std::to_string(matrix.rows) + "x" + std::to_string(matrix.columns);
}

struct RawEye {
    CameraModel camera;
    std::string distortion_name;
    bool four = false;  ///< four coefficients that are not all zero
};

RawEye read_eye(const CalibrationFile& file, const EyeKeys& keys, const std::string& usual_matrix,
                const std::string& usual_distortion, LensModel lens) {
    const auto [name, matrix] = file.matrix(keys.matrix, usual_matrix);
    if (matrix.rows != 3 || matrix.columns != 3) {
        file.fail(base::printable(name) + ": found a camera matrix of " + size_text(matrix) + ", expected 3x3");
    }
    RawEye eye;
    eye.camera = camera_of_matrix(file.path(), base::printable(name), matrix.numbers);
    const auto [distortion_name, distortion] = file.matrix(keys.distortion, usual_distortion);
    eye.distortion_name = base::printable(distortion_name);
    set_lens(eye.camera, file.path(), eye.distortion_name, distortion.numbers, lens);
    eye.four = distortion.numbers.size() == 4 && eye.camera.distortion != CameraModel{}.distortion;
    return eye;
}

/// Tells the calibrations of single cameras, which lack what stands between the two.
void refuse_single_cameras(const CalibrationFile& cameras, const CalibrationFile& pose, bool two_files) {
    if (cameras.has(left_eye_keys.matrix) || !cameras.has(single_camera_keys)) {
        return;
    }
    const bool both = two_files && pose.has(single_camera_keys);
    cameras.fail(std::string(both ? "and " + base::printable(pose.path(), 200) +
                                        " are the calibrations of two single "
                                        "cameras"
                                  : "is the calibration of one camera") +
                 ": how the right one stands to the left one (R and T) is missing: calibrate both together, as "
                 "disparityctl calibrate does; " +
                 what_is_needed);
}

void read_pose(const CalibrationFile& file, StereoCalibration& calibration) {
    const auto [rotation_name, rotation] = file.matrix(rotation_keys, "R");
    const auto [translation_name, translation] = file.matrix(translation_keys, "T");
    if (rotation.numbers.size() == 3) {
        const cv::Matx33d turn = rotation_about(cv::Vec3d(rotation.numbers.data()));
        std::copy(turn.val, turn.val + 9, calibration.rotation.begin());
    } else if (rotation.rows == 3 && rotation.columns == 3) {
        std::copy(rotation.numbers.begin(), rotation.numbers.end(), calibration.rotation.begin());
    } else {
        file.fail(base::printable(rotation_name) + ": found " + size_text(rotation) +
                  ", expected a rotation matrix of 3x3 or a rotation vector of 3 numbers");
    }
    if (translation.numbers.size() != calibration.translation.size()) {
        file.fail(base::printable(translation_name) + ": found " + base::counted(translation.numbers.size(), "number") +
                  ", expected 3");
    }
    std::copy(translation.numbers.begin(), translation.numbers.end(), calibration.translation.begin());
}

}  // namespace

FileCalibration read_opencv_calibration(const CalibrationText& cameras, const CalibrationText& pose, int width,
                                        int height, std::optional<LensModel> lens) {
    CalibrationFile file(cameras);
    const bool two_files = cameras.path != pose.path;
    const CalibrationFile second(pose);
    refuse_single_cameras(file, second, two_files);
    if (two_files) {
        file.add(second);
    }
    file.check_keys();
    const bool sized = file.check_size(width, height);
    FileCalibration result;
    StereoCalibration& calibration = result.calibration;
    calibration.width = width;
    calibration.height = height;
    const auto named = file.lens();
    const LensModel model = named.value_or(lens.value_or(LensModel::pinhole));
    const RawEye left = read_eye(file, left_eye_keys, "M1", "D1", model);
    const RawEye right = read_eye(file, right_eye_keys, "M2", "D2", model);
    if (left.four && right.four && !lens && !named) {
        file.fail(left.distortion_name +
                  ": found 4 coefficients, which are k1 k2 p1 p2 of the Brown model or k1 to k4 of a fisheye lens, and "
                  "the file does not say which: give the name with ?model=brown or ?model=fisheye behind it, or write "
                  "'distortion_model: plumb_bob' or 'distortion_model: equidistant' into the file");
    }
    calibration.left = left.camera;
    calibration.right = right.camera;
    read_pose(file, calibration);
    file.check_baseline(calibration.translation);
    if (!sized) {
        check_size_by_centre(calibration, file.path());
    }
    file.add_results(result.given);
    const auto unit = file.unit_mm();
    result.unit_mm = unit.value_or(1);
    result.unit_stated = unit.has_value();
    result.unit_doubt = file.unit_doubt();
    calibration.inertial = file.inertial();
    scale_lengths(calibration, result.unit_mm);
    return result;
}

}  // namespace disparityd::calibration
