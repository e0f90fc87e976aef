// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "tools/eval/report.h"

namespace disparityd::eval {

/// The name under which a method's result stands when every pixel is judged.
std::string fair_name(const std::string& method);

/// One line per scene: bad-1.0 over non-occluded pixels of every method as it is, and then of every one on even terms;
/// last, how much less or more each of ours has than the best of OpenCV. Then how many of ours are at most that.
void print_fair_table(const std::vector<Row>& rows, bool markdown, std::ostream& to);

}  // namespace disparityd::eval
