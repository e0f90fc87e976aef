// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/calibration/row_offsets.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>

#include "calibration/online/epipolar_fit.h"

namespace disparityd::tools {
namespace {

using calibration::CornerMatch;

constexpr double least_limit_px = 0.5;

double offset(const CornerMatch& match) {
    return match.left_y - match.right_y;
}

/// Offset = plane . (x, y, 1), with x and y in thousands of pixels: the sums stay of one size.
cv::Vec3d place(const CornerMatch& match) {
    return {match.left_x / 1000, match.left_y / 1000, 1};
}

std::vector<double> residuals(const std::vector<CornerMatch>& matches, const cv::Vec3d& plane) {
    std::vector<double> errors;
    errors.reserve(matches.size());
    for (const CornerMatch& match : matches) {
        errors.push_back(std::abs(offset(match) - plane.dot(place(match))));
    }
    return errors;
}

/// Returns the standard deviation of errors that are normally distributed but for outliers.
double deviation(const std::vector<double>& errors) {
    return 1.4826 * calibration::median(errors);
}

cv::Vec3d fit_plane(const std::vector<CornerMatch>& matches) {
    std::vector<double> offsets;
    for (const CornerMatch& match : matches) {
        offsets.push_back(offset(match));
    }
    cv::Vec3d plane(0, 0, calibration::median(offsets));
    constexpr int rounds = 20;
    constexpr double tukey = 4.685;
    for (int round = 0; round < rounds; ++round) {
        const std::vector<double> errors = residuals(matches, plane);
        const double reach = std::max(tukey * deviation(errors), 0.1);
        cv::Matx33d sums = cv::Matx33d::eye() * 1e-9;  // corners on one line determine no plane
        cv::Vec3d right;
        for (std::size_t i = 0; i < matches.size(); ++i) {
            const double part = errors[i] / reach;
            if (part < 1) {
                const double weight = (1 - part * part) * (1 - part * part);
                const cv::Vec3d at = place(matches[i]);
                sums += weight * at * at.t();
                right += weight * offset(matches[i]) * at;
            }
        }
        plane = sums.inv(cv::DECOMP_CHOLESKY) * right;
    }
    return plane;
}

}  // namespace

RowOffsets row_offsets(const std::vector<CornerMatch>& matches) {
    constexpr std::size_t least_matches = 8;
    RowOffsets result;
    if (matches.size() < least_matches) {
        result.agreeing = matches;
    } else {
        const std::vector<double> errors = residuals(matches, fit_plane(matches));
        const double limit = std::max(least_limit_px, 4 * deviation(errors));
        for (std::size_t i = 0; i < matches.size(); ++i) {
            if (errors[i] <= limit) {
                result.agreeing.push_back(matches[i]);
            }
        }
        result.wrong = 1 - static_cast<double>(result.agreeing.size()) / static_cast<double>(matches.size());
    }
    std::vector<double> sizes;
    for (const CornerMatch& match : result.agreeing) {
        sizes.push_back(std::abs(offset(match)));
    }
    result.median = calibration::median(sizes);
    return result;
}

}  // namespace disparityd::tools
