// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/eval/drive/sight.h"
#include "tools/eval/scan/course_scanner.h"

namespace disparityd::eval {

/// Returns what perfect depth shows of a course: the true disparity of each pixel, nearer than the range, too, and full
/// trust.
Sight true_sight(const Course& course, const CourseCamera& camera, const ScanSettings& settings);

}  // namespace disparityd::eval
