// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/eval/conditions/condition.h"
#include "tools/eval/drive/sight.h"
#include "tools/eval/scan/course_scanner.h"

namespace disparityd::eval {

/// A bad condition, and how bad it is. None: the course is seen as it is.
struct ConditionAt {
    const Condition* condition = nullptr;
    Strength strength = Strength::low;
};

/// Returns what stands in a course in a condition: more than before, where that is what the condition changes.
Course course_in(const Course& course, const ConditionAt& at);

/// Returns what a daemon shows of a course, frame by frame: pairs are drawn, matched, scanned and judged with the
/// stages of its pipeline, at the noise level that the frames before ask for. `course` is what course_in() has given.
/// `settings` outlive the sight. Throws as Backend::create does.
Sight matched_sight(const Course& course, const ConditionAt& at, const CourseCamera& camera,
                    const ScanSettings& settings, double frames_per_s);

}  // namespace disparityd::eval
