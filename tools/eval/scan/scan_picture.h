// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "obstacles/scan.h"
#include "tools/eval/scan/course.h"

namespace disparityd::eval {

/// Returns the left image beside the scan from above, BGR: what is free is green, obstacles are red, points of the
/// truth within the band are blue; a grey ring each 2 m up to `most_m`.
cv::Mat scan_picture(const Scan& scan, const CourseView& view, const Course& course, const CourseCamera& camera,
                     double low_m, double high_m, double most_m);

}  // namespace disparityd::eval
