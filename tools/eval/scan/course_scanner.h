// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "kernels/matcher.h"
#include "obstacles/obstacle_scanner.h"
#include "obstacles/scan.h"
#include "obstacles/scan_options.h"
#include "tools/eval/scan/course.h"

namespace disparityd::eval {

/// How courses are matched and scanned.
struct ScanSettings {
    MatchOptions match;
    ScanOptions scan;
    const Backend* backend = nullptr;
};

/// Matches and scans pairs of one camera. One thread at a time.
class CourseScanner {
public:
    /// `settings` and `workers` outlive this. Throws as Backend::create does.
    CourseScanner(const ScanSettings& settings, const CourseCamera& camera, Parallel& workers);

    /// The scan of a pair, which lasts until the next call. `sequel`: the frame follows the one before. Throws as
    /// Backend::create does.
    const Scan& scan(const cv::Mat& left, const cv::Mat& right, bool sequel);

    /// The share of pixels of the last pair that have a disparity.
    double density() const { return density_; }

private:
    const ScanSettings& settings_;
    CourseCamera camera_;
    Parallel& workers_;
    std::unique_ptr<Matcher> matcher_;
    std::optional<ObstacleScanner> scanner_;  ///< of a frame and its sequels
    Scan scan_;
    double density_ = 0;
};

/// An image of the camera's size over pixels that it does not own and must not change.
cv::Mat image_of(const std::vector<std::uint8_t>& pixels, const CourseCamera& camera);

}  // namespace disparityd::eval
