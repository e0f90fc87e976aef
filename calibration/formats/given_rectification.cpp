// SPDX-License-Identifier: Apache-2.0
#include "calibration/formats/given_rectification.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <opencv2/core/matx.hpp>

#include "calibration/formats/calibration_formats.h"
#include "calibration/formats/calibration_name.h"
#include "calibration/formats/lens_model.h"
#include "calibration/formats/pose_agreement.h"
#include "calibration/formats/rectified_eyes.h"
#include "calibration/rotation.h"

namespace disparityd::calibration {

namespace {

using What = RectificationResult;

/// What the given numbers must agree with.
struct Expected {
    cv::Matx33d left_matrix, right_matrix;
    cv::Matx33d turn;       ///< left to right camera
    cv::Vec3d translation;  ///< of the right camera, in the unit of the file
    double baseline = 0;    ///< in the unit of the file
    int width = 0;
    int height = 0;
};

cv::Matx33d pinhole_matrix(const CameraModel& camera) {
    return {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
}

Expected expected_of(const StereoCalibration& raw, double unit_mm) {
    Expected expected;
    expected.left_matrix = pinhole_matrix(raw.left);
    expected.right_matrix = pinhole_matrix(raw.right);
    expected.turn = cv::Matx33d(raw.rotation.data());
    expected.translation = cv::Vec3d(raw.translation.data()) * (1 / unit_mm);
    expected.baseline = cv::norm(expected.translation);
    expected.width = raw.width;
    expected.height = raw.height;
    return expected;
}

/// Returns a number as a message shows it, with five digits.
std::string rounded_text(double number) {
    char text[32];
    std::snprintf(text, sizeof text, "%.5g", number);
    return text;
}

std::string advice_on(const std::string& keys) {
    return "give the file whose numbers belong together, or take " + keys +
           " out, as rectification follows from the cameras, R and T alone";
}

[[noreturn]] void refuse_contradiction(const GivenResult& entry, const std::string& keys, const std::string& what) {
    refuse_calibration(entry.path, keys + ": found " + what + ": they contradict each other: " + advice_on(keys));
}

void check_shape(const GivenResult& entry, int rows, int columns) {
    if (entry.rows != rows || entry.columns != columns) {
        refuse_calibration(entry.path, entry.key + ": found a matrix of " + std::to_string(entry.rows) + "x" +
                                           std::to_string(entry.columns) + ", expected " + std::to_string(rows) + "x" +
                                           std::to_string(columns) + ": take it out, it is computed again");
    }
}

std::vector<const GivenResult*> entries_of(const std::vector<GivenResult>& given, What what) {
    std::vector<const GivenResult*> found;
    for (const GivenResult& entry : given) {
        if (entry.what == what) {
            found.push_back(&entry);
        }
    }
    return found;
}

/// Reads R1 or R2: a matrix, or a rotation vector as R may be.
cv::Matx33d turn_of(const GivenResult& entry) {
    if (entry.numbers.size() == 3) {
        return rotation_about(cv::Vec3d(entry.numbers.data()));
    }
    check_shape(entry, 3, 3);
    const cv::Matx33d turn(entry.numbers.data());
    if (!is_rotation(turn)) {
        refuse_calibration(entry.path, entry.key +
                                           ": found a matrix that is no rotation, expected rows of length 1 at right "
                                           "angles: take it out, it is computed again");
    }
    return turn;
}

/// Both eyes may be turned together about the baseline, as one likes: what R1 and R2 differ by, and where they put the
/// baseline, do not depend on that.
void check_turns(const std::vector<GivenResult>& given, const Expected& expected) {
    const auto lefts = entries_of(given, What::left_turn);
    const auto rights = entries_of(given, What::right_turn);
    for (const GivenResult* left : lefts) {
        for (const GivenResult* right : rights) {
            const cv::Matx33d between = turn_of(*right).t() * turn_of(*left);
            const double degrees = degrees_between(between, expected.turn);
            if (degrees <= largest_turn_degrees) {
                continue;
            }
            const std::string keys = left->key + " and " + right->key;
            if (degrees_between(between.t(), expected.turn) <= largest_turn_degrees) {
                refuse_calibration(left->path,
                                   keys +
                                       ": found each in place of the other, as R2^T R1 turns back what R turns: "
                                       "exchange the two, or take both out: they are computed again");
            }
            refuse_contradiction(*left, keys,
                                 "eyes that are turned to each other by " + degrees_text(degrees) +
                                     " otherwise than R says, expected at most " + degrees_text(largest_turn_degrees));
        }
    }
    const auto check_direction = [&](const GivenResult& entry, const cv::Vec3d& to_right_eye) {
        const double degrees = degrees_between(turn_of(entry) * to_right_eye, cv::Vec3d(1, 0, 0));
        if (!(degrees <= largest_direction_degrees)) {
            refuse_contradiction(entry, entry.key,
                                 "rows that run " + degrees_text(degrees) +
                                     " beside the baseline that R and T give, expected at most " +
                                     degrees_text(largest_direction_degrees));
        }
    };
    for (const GivenResult* left : lefts) {
        check_direction(*left, -(expected.turn.t() * expected.translation));
    }
    for (const GivenResult* right : rights) {
        check_direction(*right, -expected.translation);
    }
}

void check_length(const GivenResult& entry, const std::string& keys, double found, const Expected& expected) {
    if (!(std::abs(found - expected.baseline) <= largest_baseline_share * expected.baseline)) {
        refuse_contradiction(entry, keys,
                             "a baseline of " + rounded_text(found) + ", expected " + rounded_text(expected.baseline) +
                                 ", the length of T");
    }
}

EyeProjection projection_of(const GivenResult& entry) {
    check_shape(entry, 3, 4);
    return {entry.path, entry.key, entry.numbers};
}

/// f, cx and cy follow from alpha and the image size of whoever made them. Both eyes have the same f and cy, and the
/// difference of both shifts is the baseline, wherever the two are seen from.
void check_projections(const std::vector<GivenResult>& given, const Expected& expected) {
    const auto lefts = entries_of(given, What::left_projection);
    const auto rights = entries_of(given, What::right_projection);
    for (const GivenResult* right : rights) {
        const EyeProjection right_eye = projection_of(*right);
        for (const GivenResult* left : lefts) {
            const std::string keys = left->key + " and " + right->key;
            const RectifiedEyes eyes =
                rectified_eyes(projection_of(*left), right_eye, expected.width, expected.height, advice_on(keys));
            check_length(*right, keys, -eyes.shift, expected);
        }
        if (lefts.empty()) {
            check_length(*right, right->key, -right_eye.matrix[3] / right_eye.matrix[0], expected);
        }
    }
    for (const GivenResult* left : lefts) {
        const EyeProjection eye = projection_of(*left);
        const double shift = eye.matrix[3] / eye.matrix[0];
        if (rights.empty() && !(std::abs(shift) <= largest_baseline_share * expected.baseline)) {
            refuse_calibration(left->path, left->key + ": found a shift of " + rounded_text(shift) +
                                               " (row 1, column 4), expected 0 where no P2 says what that of the right "
                                               "eye is: give both, or take it out, it is computed again");
        }
    }
}

/// Q holds the baseline, and the f, cx and cy of the P1 that it was made with.
void check_to_depth(const std::vector<GivenResult>& given, const Expected& expected) {
    for (const GivenResult* entry : entries_of(given, What::to_depth)) {
        check_shape(*entry, 4, 4);
        const auto at = [&](std::size_t row, std::size_t column) {
            return entry->numbers[4 * row + column] / entry->numbers[0];
        };
        check_length(*entry, entry->key, 1 / at(3, 2), expected);
        for (const GivenResult* left : entries_of(given, What::left_projection)) {
            const auto& p = left->numbers;
            const double f = p[0];
            for (const auto& [name, in_q, in_p] :
                 {std::tuple("f", at(2, 3), f), {"cx", -at(0, 3), p[2]}, {"cy", -at(1, 3), p[6]}}) {
                constexpr double share = 0.01;
                if (!(std::abs(in_q - in_p) <= share * f)) {
                    refuse_contradiction(*entry, entry->key,
                                         std::string(name) + " " + rounded_text(in_q) + ", expected " +
                                             rounded_text(in_p) + " as " + left->key + " has it");
                }
            }
        }
    }
}

/// The essential and the fundamental matrix say the same as R, T and both cameras, but for a factor.
void check_epipolar(const std::vector<GivenResult>& given, const Expected& expected) {
    const cv::Matx33d essential = cross_product_matrix(expected.translation) * expected.turn;
    for (const What what : {What::essential, What::fundamental}) {
        for (const GivenResult* entry : entries_of(given, what)) {
            check_shape(*entry, 3, 3);
            const cv::Matx33d matrix(entry->numbers.data());
            const cv::Matx33d found =
                what == What::essential ? matrix : expected.right_matrix.t() * matrix * expected.left_matrix;
            const double cosine = std::abs(found.dot(essential)) / (cv::norm(found) * cv::norm(essential));
            const double degrees = std::acos(std::min(cosine, 1.0)) * 180 / CV_PI;
            if (!(degrees <= largest_direction_degrees)) {
                refuse_contradiction(*entry, entry->key,
                                     "a pose of the eyes that differs from R and T by " + degrees_text(degrees) +
                                         ", expected at most " + degrees_text(largest_direction_degrees));
            }
        }
    }
}

}  // namespace

std::optional<RectificationResult> rectification_result(std::string_view name) {
    struct Spelling {
        std::string_view name;
        What what;
    };
    constexpr std::array<Spelling, 11> spellings{{{"r1", What::left_turn},
                                                  {"r2", What::right_turn},
                                                  {"p1", What::left_projection},
                                                  {"p2", What::right_projection},
                                                  {"q", What::to_depth},
                                                  {"e", What::essential},
                                                  {"essential", What::essential},
                                                  {"essentialmatrix", What::essential},
                                                  {"f", What::fundamental},
                                                  {"fundamental", What::fundamental},
                                                  {"fundamentalmatrix", What::fundamental}}};
    const std::string plain = plain_name(name);
    for (const Spelling& spelling : spellings) {
        if (plain == spelling.name) {
            return spelling.what;
        }
    }
    return std::nullopt;
}

void check_given_results(const std::vector<GivenResult>& given, const StereoCalibration& raw, double unit_mm) {
    const Expected expected = expected_of(raw, unit_mm);
    check_turns(given, expected);
    check_projections(given, expected);
    check_to_depth(given, expected);
    check_epipolar(given, expected);
}

}  // namespace disparityd::calibration
