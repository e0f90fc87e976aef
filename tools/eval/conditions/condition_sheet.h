// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tools/eval/conditions/condition.h"

namespace disparityd::eval {

/// Writes a picture conditions-GROUP.jpg for each group of conditions: a row for each condition with a name, and for
/// low, middle and high strength the left and the right image beside each other. The course's first obstacle is where
/// close parts are taken. Errors as images::write_file().
void write_condition_sheets(const std::vector<const Condition*>& chosen, const Course& course,
                            const std::string& folder);

}  // namespace disparityd::eval
