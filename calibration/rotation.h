// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/matx.hpp>

/// Rotations in double precision. Of OpenCV only the small matrices of its headers, so that no library of it is needed.
namespace disparityd::calibration {

/// Returns the matrix whose product with a vector is `by` x vector.
cv::Matx33d cross_product_matrix(const cv::Vec3d& by);

/// Returns the rotation about `vector` by its length in radians, right-handed (OpenCV's Rodrigues).
cv::Matx33d rotation_about(const cv::Vec3d& vector);

/// Returns the rotation that is nearest to a matrix of positive determinant, which files give with rounded digits.
/// Sums, products and quotients only: every machine gets the same bits. Not numbers where the determinant is 0.
cv::Matx33d nearest_rotation(const cv::Matx33d& matrix);

/// Returns the rotation by half the angle; not numbers where that is 180 degrees. Bits as of nearest_rotation().
cv::Matx33d half_rotation(const cv::Matx33d& rotation);

/// Returns the shortest rotation that takes `from` to `to`, both of length 1 and not opposite. Bits as of
/// nearest_rotation().
cv::Matx33d rotation_between(const cv::Vec3d& from, const cv::Vec3d& to);

}  // namespace disparityd::calibration
