// SPDX-License-Identifier: Apache-2.0
#include "calibration/online/epipolar_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <opencv2/core/matx.hpp>

#include "calibration/rotation.h"

namespace disparityd::calibration {

namespace {

using Normal = cv::Matx<double, parameters, parameters>;
using Vector = cv::Vec<double, parameters>;

// Standard deviations of the prior that holds yaw (rad) and focal length near 0.
constexpr std::pair<Parameter, double> beliefs[] = {{yaw, 0.3 * std::numbers::pi / 180}, {focal, 0.005}};

/// Returns the rotation about an axis by the length of the axis (Rodrigues' formula). Uses series: angles are small,
/// and libraries differ in the last digit of a sine.
cv::Matx33d rotation_by(double x, double y, double z) {
    const double square = x * x + y * y + z * z;
    const double sine = 1 - square / 6 * (1 - square / 20);        // sin a / a
    const double versine = 0.5 - square / 24 * (1 - square / 30);  // (1 - cos a) / a^2
    const cv::Matx33d cross = cross_product_matrix({x, y, z});
    return cv::Matx33d::eye() + sine * cross + versine * (cross * cross);
}

/// Inverts a symmetric, positive definite matrix by elimination; nothing when it is nearly singular.
std::optional<Normal> inverted(Normal matrix) {
    Normal inverse = Normal::eye();
    for (int i = 0; i < parameters; ++i) {
        const double pivot = matrix(i, i);
        if (!(pivot > 1e-9)) {
            return std::nullopt;
        }
        for (int row = 0; row < parameters; ++row) {
            const double part = matrix(row, i) / pivot;
            for (int column = 0; row != i && column < parameters; ++column) {
                matrix(row, column) -= part * matrix(i, column);
                inverse(row, column) -= part * inverse(i, column);
            }
        }
    }
    for (int row = 0; row < parameters; ++row) {
        for (int column = 0; column < parameters; ++column) {
            inverse(row, column) /= matrix(row, row);
        }
    }
    return inverse;
}

/// Returns Tukey's biweight: 1 for 0, and 0 from `limit` on.
double tukey(double error, double limit) {
    const double part = error / limit;
    const double rest = std::max(0.0, 1 - part * part);
    return rest * rest;
}

/// Returns 1.4826 times the median of absolute values: the standard deviation without outliers.
double spread(std::vector<double> errors) {
    for (double& error : errors) {
        error = std::abs(error);
    }
    return 1.4826 * median(errors);
}

class Fit {
public:
    Fit(const StereoCalibration& calibration, double f, std::span<const RayPair> pairs,
        const std::array<bool, parameters>& fixed)
        : calibration_(calibration),
          f_(f),
          pairs_(pairs),
          fixed_(fixed),
          errors_(pairs.size()),
          slopes_(pairs.size()) {}

    /// Computes errors and slopes at the present change, and the error from which on a pair has weight 0.
    void look(double widening) {
        const VerticalError error(calibration_, f_, change_);
        for (std::size_t i = 0; i < pairs_.size(); ++i) {
            errors_[i] = error.with_slopes(pairs_[i], slopes_[i]);
        }
        constexpr double usual = 4.685;  // 95 % of the efficiency of least squares
        constexpr double finest = 0.02;  // px; matches are never better
        spread_ = std::max(finest, spread(errors_));
        limit_ = usual * widening * spread_;
    }

    bool step() {
        Vector gradient;
        const auto inverse = inverted(equations(gradient));
        if (!inverse) {
            return false;
        }
        const Vector change = *inverse * gradient;
        for (int i = 0; i < parameters; ++i) {
            change_[static_cast<std::size_t>(i)] -= change[i];
        }
        return true;
    }

    EpipolarFit result(int blocks) {
        EpipolarFit fit;
        Vector gradient;
        const auto inverse = inverted(equations(gradient));
        std::vector<Vector> pull(static_cast<std::size_t>(blocks), Vector::all(0));
        std::vector<bool> used(static_cast<std::size_t>(blocks), false);
        std::size_t inliers = 0;
        for (std::size_t i = 0; i < pairs_.size(); ++i) {
            const double weight = tukey(errors_[i], limit_);
            const auto block = static_cast<std::size_t>(pairs_[i].block);
            pull[block] += weight * errors_[i] * Vector(slopes_[i].data());
            used[block] = used[block] || weight > 0;
            inliers += weight > 0 ? 1 : 0;
        }
        Normal scatter = Normal::zeros();
        for (const Vector& vector : pull) {
            scatter += vector * vector.t();
        }
        for (const auto& [parameter, belief] : beliefs) {
            scatter(parameter, parameter) += spread_ * spread_ * spread_ * spread_ / (belief * belief);
        }
        fit.blocks_used = static_cast<int>(std::count(used.begin(), used.end(), true));
        const int surplus = fit.blocks_used - parameters;
        fit.solved = inverse && surplus > 0;
        if (fit.solved) {
            const Normal covariance = *inverse * scatter * inverse->t();
            for (int i = 0; i < parameters; ++i) {
                fit.deviation[static_cast<std::size_t>(i)] = std::sqrt(covariance(i, i) * fit.blocks_used / surplus);
            }
        }
        fit.change = change_;
        fit.inliers = static_cast<double>(inliers) / static_cast<double>(std::max<std::size_t>(1, pairs_.size()));
        return fit;
    }

private:
    Normal equations(Vector& gradient) const {
        Normal normal = Normal::zeros();
        gradient = Vector::all(0);
        for (std::size_t i = 0; i < pairs_.size(); ++i) {
            const double weight = tukey(errors_[i], limit_);
            if (weight > 0) {
                const Vector slope(slopes_[i].data());
                normal += weight * (slope * slope.t());
                gradient += weight * errors_[i] * slope;
            }
        }
        const double variance = spread_ * spread_;
        for (const auto& [parameter, belief] : beliefs) {
            normal(parameter, parameter) += variance / (belief * belief);
            gradient[parameter] += variance / (belief * belief) * change_[parameter];
        }
        for (int i = 0; i < parameters; ++i) {
            if (fixed_[static_cast<std::size_t>(i)]) {
                for (int j = 0; j < parameters; ++j) {
                    normal(i, j) = normal(j, i) = i == j ? 1 : 0;
                }
                gradient[i] = 0;
            }
        }
        return normal;
    }

    const StereoCalibration& calibration_;
    const double f_;
    const std::span<const RayPair> pairs_;
    const std::array<bool, parameters> fixed_;
    std::vector<double> errors_;
    std::vector<Parameters> slopes_;
    Parameters change_{};
    double spread_ = 0;
    double limit_ = 0;
};

}  // namespace

VerticalError::VerticalError(const StereoCalibration& calibration, double f, const Parameters& change)
    : f_(f), focal_(1 + change[focal]) {
    const cv::Matx33d rotation =
        rotation_by(change[pitch], change[yaw], change[roll]) * cv::Matx33d(calibration.rotation.data());
    std::copy(rotation.val, rotation.val + 9, rotation_.begin());
    const cv::Vec3d translation(calibration.translation.data());
    const cv::Vec3d direction = translation / std::sqrt(translation.dot(translation));
    std::copy(direction.val, direction.val + 3, direction_.begin());
}

double VerticalError::operator()(const RayPair& pair) const {
    Parameters slopes;
    return with_slopes(pair, slopes);
}

double VerticalError::with_slopes(const RayPair& pair, Parameters& slopes) const {
    const cv::Vec3d left(pair.left_x, pair.left_y, 1);
    const cv::Vec3d right(pair.right_x / focal_, pair.right_y / focal_, 1);
    const cv::Vec3d turned = cv::Matx33d(rotation_.data()) * left;
    const cv::Vec3d direction(direction_.data());
    // right . (T x R left) = 0 for two rays to one point; with T along -x this is the difference of the two y.
    const double scale = -f_ / turned[2];
    const cv::Vec3d normal = direction.cross(turned);
    const cv::Vec3d by_turn = scale * turned.cross(right.cross(direction));
    for (int i = 0; i < 3; ++i) {
        slopes[static_cast<std::size_t>(i)] = by_turn[i];
    }
    slopes[focal] = -scale * (right[0] * normal[0] + right[1] * normal[1]) / focal_;
    return scale * right.dot(normal);
}

EpipolarFit fit_epipolar(const StereoCalibration& calibration, double f, std::span<const RayPair> pairs, int blocks,
                         const std::array<bool, parameters>& fixed) {
    if (pairs.empty()) {
        return {};
    }
    Fit fit(calibration, f, pairs, fixed);
    // The limit is wide at first, while the errors still contain the change.
    constexpr int steps = 20;
    for (int i = 0; i < steps; ++i) {
        fit.look(i < 5 ? 3 : 1);
        if (!fit.step()) {
            return {};
        }
    }
    fit.look(1);
    return fit.result(blocks);
}

double median(std::span<const double> values) {
    if (values.empty()) {
        return 0;
    }
    std::vector<double> sorted(values.begin(), values.end());
    std::sort(sorted.begin(), sorted.end());
    const std::size_t middle = sorted.size() / 2;
    return sorted.size() % 2 == 1 ? sorted[middle] : 0.5 * (sorted[middle - 1] + sorted[middle]);
}

}  // namespace disparityd::calibration
